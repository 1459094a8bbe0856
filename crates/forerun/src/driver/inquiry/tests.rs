//! Questions without a thread: who is answered, when, and with what.

use forerun_timeline::{Change, Progress};

use super::*;
use crate::driver::decoupled::tests::{LOOKAHEAD, timeline};
use crate::{BodyId, Vec3};

fn full() -> Timeline {
    let mut timeline = timeline();
    while timeline.advance() != Progress::Idle {}
    timeline
}

fn push(frames: u32) -> Preview {
    let change = Change::Push { body: BodyId(1), impulse: Vec3::X * 1000.0, at_point: None };
    Preview { frame: Frame(5), changes: vec![change], frames, bodies: vec![] }
}

/// All answers, by a clock that goes on by so many seconds a frame.
fn worked(inquirer: &mut Inquirer, frame_s: f64) -> Vec<Answered> {
    let mut answers = Vec::new();
    let mut now_s = 0.0;
    while !inquirer.is_idle() {
        answers.extend(inquirer.work(now_s));
        now_s += frame_s;
    }
    answers
}

#[test]
fn of_each_kind_the_newest_question_is_answered() {
    let timeline = full();
    let mut inquirer = Inquirer::default();
    for number in [0, 2] {
        inquirer.ask_inspect(Ticket(number), timeline.snapshot(), Frame(number));
        inquirer.ask_preview(Ticket(number + 1), timeline.fork(), push(10));
    }
    let answers = worked(&mut inquirer, 0.001);
    let tickets: Vec<u64> = answers.iter().map(|answered| answered.ticket.0).collect();
    assert_eq!(tickets, [2, 3]);
    assert!(matches!(&answers[0].answer, Ok(Answer::Inspect(inspection)) if inspection.frame == Frame(2)));
    let Ok(Answer::Preview(previewed)) = &answers[1].answer else { panic!("{answers:?}") };
    assert_eq!((previewed.to, previewed.trails.len()), (Frame(15), 1));
}

#[test]
fn what_is_asked_again_and_again_does_not_keep_the_other_kind_from_its_turn() {
    let timeline = full();
    let mut inquirer = Inquirer::default();
    inquirer.ask_preview(Ticket(0), timeline.fork(), push(10));
    let mut calls = 0;
    let previewed = std::iter::repeat_with(|| {
        calls += 1;
        inquirer.ask_inspect(Ticket(calls), timeline.snapshot(), Frame(3));
        inquirer.work(0.0)
    });
    let first = previewed.flatten().find(|answered| matches!(answered.answer, Ok(Answer::Preview(_))));
    assert_eq!(first.map(|answered| answered.ticket), Some(Ticket(0)));
    assert!(calls < 40, "after {calls} calls");
}

#[test]
fn a_long_preview_is_told_as_far_as_it_is_known_when_a_newer_one_waits() {
    let timeline = full();
    let mut inquirer = Inquirer::default();
    inquirer.ask_preview(Ticket(0), timeline.fork(), push(LOOKAHEAD * 10));
    assert_eq!(inquirer.work(1.0), None);
    inquirer.ask_preview(Ticket(1), timeline.fork(), push(3));
    // Not at once: pictures come faster than answers, and half an answer is better than none.
    assert_eq!(inquirer.work(1.0 + 0.9 * PATIENCE_S), None);
    let short = inquirer.work(1.0 + 1.1 * PATIENCE_S).expect("it is time");
    let Ok(Answer::Preview(told)) = short.answer else { panic!("{short:?}") };
    // Frames 5 to 7 are what three calls compute.
    assert_eq!((short.ticket, told.to), (Ticket(0), Frame(7)));
    assert_eq!(told.trails[0].poses.len(), 4);
    assert_eq!(worked(&mut inquirer, 0.0).last().map(|answered| answered.ticket), Some(Ticket(1)));
}

#[test]
fn what_cannot_be_answered_is_said() {
    let timeline = full();
    let mut inquirer = Inquirer::default();
    inquirer.ask_inspect(Ticket(0), timeline.snapshot(), Frame(77));
    inquirer.ask_preview(Ticket(1), timeline.fork(), Preview { frame: Frame(0), ..push(5) });
    let errors: Vec<String> = worked(&mut inquirer, 0.0)
        .into_iter()
        .map(|answered| answered.answer.expect_err("it is not possible").to_string())
        .collect();
    assert_eq!(errors.len(), 2);
    assert_eq!(errors[0], "frame 77 is not stored: ask for one from frame 0 to frame 20");
    assert!(errors[1].starts_with("preview: frame 0 is too old"), "{}", errors[1]);
}

#[test]
fn a_dead_thread_is_an_error_and_not_silence() {
    let inquiry = desk::Inquiry::start().expect("a thread");
    let ask = |inquiry: &desk::Inquiry| {
        let (ticket, snapshot, frame) = (Ticket(0), full().snapshot(), Frame(1));
        inquiry.ask_inspection(desk::AskedInspection { ticket, snapshot, frame })
    };
    assert_eq!(ask(&inquiry), Ok(()));
    inquiry.kill("a bug");
    let answers: Vec<_> = std::iter::repeat_with(|| {
        std::thread::sleep(std::time::Duration::from_millis(1));
        inquiry.answers()
    })
    .take(10_000)
    .skip_while(Result::is_ok)
    .take(1)
    .collect();
    let dead = crate::DriverError::AnswersPanicked("a bug".to_owned());
    assert_eq!(answers, [Err(dead.clone())]);
    assert_eq!(ask(&inquiry), Err(dead));
}
