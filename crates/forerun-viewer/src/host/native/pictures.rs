//! Pictures and films of the desktop: compressed and written by threads.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};

use super::files::{new_file, new_folder, save_file};
use crate::capture::{FilmFormat, FilmSettings, Shot};

/// Pictures of a film that may wait to be written.
const WAITING_MAX: usize = 4;

/// A file that is being written: where it went, or why not.
#[derive(Debug)]
pub struct Saving {
    saved: Receiver<Result<String, String>>,
}

/// Writes a picture as PNG.
#[must_use]
pub fn save_picture(name: &str, shot: Shot) -> Saving {
    save_later(name, move || shot.png())
}

/// Writes a text.
#[must_use]
pub fn save_text(name: &str, text: String) -> Saving {
    save_later(name, move || Ok(text.into_bytes()))
}

fn save_later(name: &str, content: impl FnOnce() -> Result<Vec<u8>, String> + Send + 'static) -> Saving {
    let (sender, saved) = channel();
    let name = name.to_owned();
    std::thread::spawn(move || {
        let done = content().and_then(|content| save_file(&name, &content));
        // When nobody waits for it any more, the viewer has ended.
        let _ = sender.send(done);
    });
    Saving { saved }
}

impl Saving {
    /// Where it went or why not, once it is written.
    pub fn poll(&mut self) -> Option<Result<String, String>> {
        match self.saved.try_recv() {
            Ok(saved) => Some(saved),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the thread that writes has ended early".to_owned())),
        }
    }
}

/// Writes a film, in a thread of its own.
#[derive(Debug)]
pub struct FilmWriter {
    pictures: Option<SyncSender<Shot>>,
    waiting: Arc<AtomicUsize>,
    saving: Saving,
}

impl FilmWriter {
    /// Begins the file or folder of a film.
    ///
    /// # Errors
    /// When it cannot be begun: no room, no right, no `ffmpeg`.
    pub fn start(settings: &FilmSettings, stem: &str, size: [u32; 2]) -> Result<FilmWriter, String> {
        let reel = Reel::new(settings, stem, size)?;
        let (sender, saved) = channel();
        let (pictures, taken) = sync_channel::<Shot>(WAITING_MAX);
        let waiting = Arc::new(AtomicUsize::new(0));
        let left = Arc::clone(&waiting);
        // When nobody waits for it any more, the viewer has ended.
        std::thread::spawn(move || drop(sender.send(write(reel, &taken, &left, size))));
        Ok(FilmWriter { pictures: Some(pictures), waiting, saving: Saving { saved } })
    }

    /// Whether one more picture can wait.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.waiting.load(Ordering::Relaxed) < WAITING_MAX
    }

    /// One more picture. Never waits: there is [room](FilmWriter::has_room), or it is left out.
    pub fn push(&mut self, shot: Shot) {
        let Some(pictures) = &self.pictures else { return };
        // Before it is sent: who takes it counts it down.
        self.waiting.fetch_add(1, Ordering::Relaxed);
        if pictures.try_send(shot).is_err() {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// No more pictures.
    pub fn end(&mut self) {
        self.pictures = None;
    }

    /// Where it went or why not, once all of it is written.
    pub fn poll(&mut self) -> Option<Result<String, String>> {
        self.saving.poll()
    }
}

fn write(
    mut reel: Reel,
    taken: &Receiver<Shot>,
    left: &AtomicUsize,
    size: [u32; 2],
) -> Result<String, String> {
    let mut count = 0_u64;
    while let Ok(shot) = taken.recv() {
        let fitting = fit(shot, size);
        let put = reel.put(&fitting, count);
        left.fetch_sub(1, Ordering::Relaxed);
        put.map_err(|error| format!("the film {} ends early: {error}", reel.path().display()))?;
        count += 1;
    }
    let path = reel.path().to_owned();
    reel.finish().map_err(|error| format!("the film {} is not whole: {error}", path.display()))?;
    Ok(format!("{} ({count} pictures)", path.display()))
}

/// The picture in the size of the film: those drawn twice as large are made smooth by it, others are cut or filled with black.
fn fit(shot: Shot, size: [u32; 2]) -> Shot {
    let shot = if shot.size == size.map(|side| 2 * side) { shot.halved() } else { shot };
    if shot.size == size {
        return shot;
    }
    let mut pixels = vec![[0, 0, 0, 255]; (size[0] * size[1]) as usize];
    let width = shot.size[0].min(size[0]) as usize;
    for y in 0..shot.size[1].min(size[1]) as usize {
        let (to, from) = (y * size[0] as usize, y * shot.size[0] as usize);
        pixels[to..to + width].copy_from_slice(&shot.pixels[from..from + width]);
    }
    Shot { size, pixels }
}

/// What a film is written into.
enum Reel {
    Folder(PathBuf),
    Gif { path: PathBuf, encoder: Box<gif::Encoder<BufWriter<std::fs::File>>>, fps: u32 },
    Ffmpeg { path: PathBuf, program: Child, input: Option<ChildStdin> },
}

impl Reel {
    fn new(settings: &FilmSettings, stem: &str, size: [u32; 2]) -> Result<Reel, String> {
        match settings.format {
            FilmFormat::Png => new_folder(stem).map(Reel::Folder),
            FilmFormat::Gif => Reel::gif(stem, settings.fps, size),
            FilmFormat::Mp4 => Reel::ffmpeg(stem, settings.fps, size),
        }
    }

    fn gif(stem: &str, fps: u32, size: [u32; 2]) -> Result<Reel, String> {
        let sides = size.map(u16::try_from);
        let [Ok(width), Ok(height)] = sides else {
            return Err("a GIF has at most 65535 pixels a side".to_owned());
        };
        let (path, file) = new_file(stem, "gif")?;
        let cannot = |error: String| format!("cannot write {}: {error}", path.display());
        let mut encoder = gif::Encoder::new(BufWriter::new(file), width, height, &[])
            .map_err(|error| cannot(error.to_string()))?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(|error| cannot(error.to_string()))?;
        Ok(Reel::Gif { path, encoder: Box::new(encoder), fps })
    }

    fn ffmpeg(stem: &str, fps: u32, size: [u32; 2]) -> Result<Reel, String> {
        // Its name is taken now; the program writes over it.
        let (path, _) = new_file(stem, "mp4")?;
        let mut program = Command::new("ffmpeg")
            .args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"])
            .args(["-s", &format!("{}x{}", size[0], size[1]), "-r", &fps.to_string(), "-i", "-"])
            .args(["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"])
            .arg(&path)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| {
                // Nothing comes into it any more.
                let _ = std::fs::remove_file(&path);
                format!("ffmpeg does not start ({error}): install it, or choose GIF or PNG files")
            })?;
        let input = program.stdin.take();
        Ok(Reel::Ffmpeg { path, program, input })
    }

    fn path(&self) -> &Path {
        match self {
            Reel::Folder(path) | Reel::Gif { path, .. } | Reel::Ffmpeg { path, .. } => path,
        }
    }

    fn put(&mut self, shot: &Shot, number: u64) -> Result<(), String> {
        match self {
            Reel::Folder(path) => {
                let file = path.join(format!("{number:05}.png"));
                std::fs::write(file, shot.png()?).map_err(|error| error.to_string())
            }
            Reel::Gif { encoder, fps, .. } => {
                let mut bytes = shot.bytes().to_vec();
                let mut frame =
                    gif::Frame::from_rgba_speed(encoder_side(shot, 0), encoder_side(shot, 1), &mut bytes, 10);
                frame.delay = delay_cs(number, *fps);
                encoder.write_frame(&frame).map_err(|error| error.to_string())
            }
            Reel::Ffmpeg { input, .. } => {
                let input = input.as_mut().ok_or("ffmpeg takes no pictures")?;
                input.write_all(shot.bytes()).map_err(|error| format!("ffmpeg: {error}"))
            }
        }
    }

    fn finish(self) -> Result<(), String> {
        match self {
            Reel::Folder(_) => Ok(()),
            Reel::Gif { encoder, .. } => {
                let mut file = encoder.into_inner().map_err(|error| error.to_string())?;
                file.flush().map_err(|error| error.to_string())
            }
            Reel::Ffmpeg { mut program, input, .. } => {
                drop(input);
                let status = program.wait().map_err(|error| error.to_string())?;
                if status.success() { Ok(()) } else { Err(format!("ffmpeg ended with {status}")) }
            }
        }
    }
}

/// Sides were checked when the film began.
fn encoder_side(shot: &Shot, side: usize) -> u16 {
    u16::try_from(shot.size[side]).unwrap_or(u16::MAX)
}

/// How long a picture of a GIF stays: hundredths of a second, which do not divide 30 pictures a second; the sum is right.
fn delay_cs(number: u64, fps: u32) -> u16 {
    let at = |number: u64| (number * 100 + u64::from(fps) / 2) / u64::from(fps);
    (at(number + 1) - at(number)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gif_of_thirty_pictures_a_second_lasts_as_long_as_the_film() {
        let sum: u32 = (0..300).map(|number| u32::from(delay_cs(number, 30))).sum();
        assert_eq!(sum, 1000);
        assert!((0..300).all(|number| (3..=4).contains(&delay_cs(number, 30))));
    }

    fn film(format: FilmFormat, name: &str) -> String {
        let settings = FilmSettings { format, fps: 25, ..FilmSettings::default() };
        let stem = format!("forerun-film-{name}-{}", std::process::id());
        let mut writer = FilmWriter::start(&settings, &stem, [16, 8]).expect("it can be begun");
        for grey in [0, 100, 200] {
            while !writer.has_room() {
                std::thread::yield_now();
            }
            writer.push(Shot { size: [32, 16], pixels: vec![[grey, grey, grey, 255]; 512] });
        }
        writer.end();
        loop {
            if let Some(written) = writer.poll() {
                let written = written.expect("it can be written");
                return written.strip_suffix(" (3 pictures)").expect("three were given").to_owned();
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn a_film_of_three_pictures_is_three_numbered_files() {
        let folder = film(FilmFormat::Png, "png");
        for (number, grey) in [0, 100, 200].into_iter().enumerate() {
            let file = std::fs::File::open(format!("{folder}/{number:05}.png")).expect("it is there");
            let mut reader = png::Decoder::new(file).read_info().expect("it is a PNG");
            let mut bytes = vec![0; reader.output_buffer_size()];
            reader.next_frame(&mut bytes).expect("it holds a picture");
            assert_eq!(bytes[..4], [grey, grey, grey, 255]);
            assert_eq!(bytes.len(), 16 * 8 * 4);
        }
        std::fs::remove_dir_all(folder).expect("it was written just now");
    }

    #[test]
    fn a_gif_has_all_pictures_at_their_times() {
        let path = film(FilmFormat::Gif, "gif");
        let file = std::fs::File::open(&path).expect("it is there");
        let mut decoder = gif::DecodeOptions::new().read_info(file).expect("it is a GIF");
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().expect("it is whole") {
            delays.push(frame.delay);
        }
        assert_eq!(delays, [4, 4, 4]);
        std::fs::remove_file(path).expect("it was written just now");
    }

    #[test]
    fn every_picture_fits_the_film() {
        let shot = |size: [u32; 2]| Shot { size, pixels: vec![[9, 9, 9, 255]; (size[0] * size[1]) as usize] };
        for size in [[8, 6], [16, 12], [5, 20], [20, 3]] {
            let fitting = fit(shot(size), [8, 6]);
            assert_eq!((fitting.size, fitting.pixels.len()), ([8, 6], 48));
        }
        assert_eq!(fit(shot([16, 12]), [8, 6]).pixels[0], [9, 9, 9, 255]);
        assert_eq!(fit(shot([4, 6]), [8, 6]).pixels[4], [0, 0, 0, 255]);
    }
}
