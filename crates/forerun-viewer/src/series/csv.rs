//! Series as tables: the columns of `queue.csv`, and of the other two their own.

use std::fmt::Write;

use forerun::{QueueRow, Stage, write_queue_csv};

use super::{EditRow, PictureRow, Ring, StepRow};

/// One line a picture: the columns of `queue.csv`.
#[must_use]
pub fn pictures_csv(rows: &Ring<PictureRow>) -> String {
    let rows: Vec<QueueRow> = rows.iter().map(|picture| picture.row).collect();
    let mut table = Vec::new();
    // A Vec takes everything.
    let _ = write_queue_csv(&rows, &mut table);
    String::from_utf8_lossy(&table).into_owned()
}

/// One line a computed frame: how long each stage took.
#[must_use]
pub fn steps_csv(rows: &Ring<StepRow>) -> String {
    let mut table = "time_real_s,number,frame,extended,recomputed,affected".to_owned();
    for stage in Stage::ALL {
        let _ = write!(table, ",{}_ms", stage.name());
    }
    table.push_str(",other_ms\n");
    for StepRow { time_real_s, times } in rows.iter() {
        let _ = write!(
            table,
            "{time_real_s:.6},{},{},{},",
            times.number,
            times.frame.0,
            u8::from(times.extended)
        );
        let _ = write!(table, "{},{}", times.recomputed, times.affected);
        for seconds in times.seconds.iter().chain([&times.other_s]) {
            let _ = write!(table, ",{:.4}", f64::from(*seconds) * 1e3);
        }
        table.push('\n');
    }
    table
}

/// One line an edit: what it cost, and what stepping everything again would have.
#[must_use]
pub fn edits_csv(rows: &Ring<EditRow>) -> String {
    let mut table = "time_real_s,frame,commands,frames,recomputed,affected,full\n".to_owned();
    for EditRow { time_real_s, edit } in rows.iter() {
        let _ = writeln!(
            table,
            "{time_real_s:.6},{},{},{},{},{},{}",
            edit.frame.0, edit.commands, edit.frames, edit.recomputed, edit.affected, edit.full
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use forerun::{Edit, StageTimes};

    #[test]
    fn every_line_has_as_many_fields_as_the_header() {
        let mut pictures = Ring::with_capacity(4);
        pictures
            .push(PictureRow { row: QueueRow { time_real_s: 0.5, ..QueueRow::default() }, wished_s: 0.5 });
        let mut steps = Ring::with_capacity(4);
        steps.push(StepRow { time_real_s: 0.5, times: StageTimes { number: 3, ..StageTimes::default() } });
        let mut edits = Ring::with_capacity(4);
        edits.push(EditRow { time_real_s: 0.5, edit: Edit::default() });
        for table in [pictures_csv(&pictures), steps_csv(&steps), edits_csv(&edits)] {
            let fields: Vec<usize> = table.lines().map(|line| line.split(',').count()).collect();
            assert_eq!(fields.len(), 2, "{table}");
            assert_eq!(fields[0], fields[1], "{table}");
        }
    }
}
