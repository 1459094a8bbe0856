//! A picture as pixels.

use three_d::egui;

/// A picture: rows from the top, four bytes a pixel.
#[derive(Clone, PartialEq, Eq)]
pub struct Shot {
    /// Width and height. Pixels.
    pub size: [u32; 2],
    /// Red, green, blue, opacity.
    pub pixels: Vec<[u8; 4]>,
}

impl std::fmt::Debug for Shot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Shot({} x {})", self.size[0], self.size[1])
    }
}

impl Shot {
    /// What has been drawn into a target of the graphics card. Windows may leave holes in their opacity; pictures have none.
    #[must_use]
    pub fn of(target: &three_d::RenderTarget<'_>) -> Shot {
        let mut pixels = target.read_color::<[u8; 4]>();
        pixels.iter_mut().for_each(|pixel| pixel[3] = 255);
        Shot { size: [target.width(), target.height()], pixels }
    }

    /// The part in a rectangle of points, as far as it lies in the picture.
    #[must_use]
    pub fn cropped(&self, part: egui::Rect, pixels_per_point: f32) -> Shot {
        let side = |at: f32, end: u32| ((at * pixels_per_point).round().max(0.0) as u32).min(end);
        let [left, right] = [part.min.x, part.max.x].map(|x| side(x, self.size[0]));
        let [top, bottom] = [part.min.y, part.max.y].map(|y| side(y, self.size[1]));
        let row = |y: u32| {
            let start = (y * self.size[0]) as usize;
            &self.pixels[start + left as usize..start + right.max(left) as usize]
        };
        let pixels = (top..bottom.max(top)).flat_map(|y| row(y).iter().copied()).collect();
        Shot { size: [right.saturating_sub(left), bottom.saturating_sub(top)], pixels }
    }

    /// Half as wide and high: the mean of each four. An odd last row or column goes.
    #[must_use]
    pub fn halved(&self) -> Shot {
        let size = self.size.map(|side| side / 2);
        let at = |x: u32, y: u32| self.pixels[(y * self.size[0] + x) as usize];
        let mut pixels = Vec::with_capacity((size[0] * size[1]) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let four =
                    [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
                let mean = |i: usize| (four.iter().map(|pixel| u32::from(pixel[i])).sum::<u32>() / 4) as u8;
                pixels.push([mean(0), mean(1), mean(2), mean(3)]);
            }
        }
        Shot { size, pixels }
    }

    /// The bytes in a row, from the top left.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.pixels.as_flattened()
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// When the picture has no pixels.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(self.bytes()));
        written
            .map(|()| file)
            .map_err(|error| format!("a picture of {} x {} pixels: {error}", self.size[0], self.size[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chequered(size: [u32; 2]) -> Shot {
        let pixel = |x: u32, y: u32| [x as u8, y as u8, ((x + y) % 2 * 200) as u8, 255];
        Shot { size, pixels: (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| pixel(x, y))).collect() }
    }

    #[test]
    fn a_part_is_cut_out_by_points_and_never_beyond_the_edge() {
        let shot = chequered([20, 10]);
        let part = shot.cropped(egui::Rect::from_min_max(egui::pos2(2.0, 1.0), egui::pos2(5.0, 3.0)), 2.0);
        assert_eq!(part.size, [6, 4]);
        assert_eq!(part.pixels[0], [4, 2, 0, 255]);
        assert_eq!(part.pixels.len(), 24);
        let beyond =
            shot.cropped(egui::Rect::from_min_max(egui::pos2(-5.0, -5.0), egui::pos2(99.0, 99.0)), 1.0);
        assert_eq!(beyond, shot);
        let nothing = shot.cropped(egui::Rect::from_min_max(egui::pos2(9.0, 9.0), egui::pos2(3.0, 3.0)), 1.0);
        assert!(nothing.pixels.is_empty());
        assert!(nothing.png().is_err());
    }

    #[test]
    fn half_a_picture_is_the_mean_of_fours() {
        let half = chequered([5, 4]).halved();
        assert_eq!(half.size, [2, 2]);
        assert_eq!(half.pixels[0], [0, 0, 100, 255]);
        assert_eq!(half.pixels[3], [2, 2, 100, 255]);
    }

    #[test]
    fn a_png_holds_the_pixels() {
        let shot = chequered([7, 5]);
        let file = shot.png().expect("it has pixels");
        let mut reader = png::Decoder::new(file.as_slice()).read_info().expect("it is a PNG");
        let mut bytes = vec![0; reader.output_buffer_size()];
        reader.next_frame(&mut bytes).expect("it holds a picture");
        assert_eq!(bytes, shot.bytes());
    }
}
