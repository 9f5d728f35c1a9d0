//! The simulator waits for its pictures.

use super::*;
use std::io::Read;
use std::net::UdpSocket;
use terrella_orbit::Feed;

/// Draws frames until `count` are drawn; gives their numbers.
fn draw(feed: &LiveFeed, count: usize) -> Vec<u64> {
    (0..count)
        .map(|_| {
            let request = feed.wait_request(PATIENCE).expect("a frame");
            assert_eq!(feed.state_at(request.state.epoch).unwrap(), request.state);
            assert!(feed.acknowledge(&request));
            assert!(!feed.acknowledge(&request), "it is drawn once");
            request.seq
        })
        .collect()
}

#[test]
fn each_frame_is_answered_when_it_is_drawn() {
    let (feed, address) = open(lockstep(tcp()));
    assert_eq!(feed.next_request(), None);
    let begun = Instant::now();
    let simulator = std::thread::spawn(move || {
        let stream = connect(address);
        for seq in 1..=200 {
            // Forwards, a long way on, and back.
            let t_s = [1.0, 2.0, 1e6, 3.0][seq as usize % 4] * seq as f64;
            send_line(&stream, &frame(seq, t_s));
            let answer = answer_line(&stream);
            assert_eq!(answer, serde_json::json!({"message": "ack", "seq": seq}));
        }
    });
    assert_eq!(draw(&feed, 200), (1..=200).collect::<Vec<_>>());
    simulator.join().unwrap();
    println!("200 frames in {:?}", begun.elapsed());
    until("200 drawn", || feed.counters().drawn == 200);
    assert_eq!(feed.counters().timed_out, 0);
}

#[test]
fn no_answer_comes_before_the_picture_is_drawn() {
    let (feed, address) = open(lockstep(tcp()));
    let mut stream = connect(address);
    send_line(&stream, &frame(1, 1.0));
    let request = feed.wait_request(PATIENCE).unwrap();
    assert_eq!(feed.next_request(), None, "it is handed out once");
    stream
        .set_read_timeout(Some(Duration::from_millis(300)))
        .unwrap();
    assert!(
        stream.read(&mut [0]).is_err(),
        "an answer without a picture"
    );
    assert!(feed.acknowledge(&request));
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    assert_eq!(answer_line(&stream)["message"], "ack");
}

#[test]
fn a_frame_that_is_not_drawn_in_time_is_an_error_to_the_simulator() {
    let (feed, address) = open(LiveOptions {
        frame_timeout: Duration::from_millis(200),
        ..lockstep(tcp())
    });
    let stream = connect(address);
    send_line(&stream, &frame(5, 1.0));
    let request = feed.wait_request(PATIENCE).unwrap();
    let answer = answer_line(&stream);
    assert_eq!(answer["message"], "error");
    assert_eq!(answer["seq"], 5);
    assert_eq!(answer["error"], "not drawn within 0.2 s");
    assert!(!feed.acknowledge(&request), "nobody waits for it any more");
    assert_eq!(feed.counters().timed_out, 1);
    // It goes on.
    send_line(&stream, &frame(6, 2.0));
    assert_eq!(draw(&feed, 1), [6]);
    assert_eq!(answer_line(&stream)["seq"], 6);
}

#[test]
fn a_player_can_say_why_there_is_no_picture() {
    let (feed, address) = open(lockstep(tcp()));
    let stream = connect(address);
    send_line(&stream, &frame(1, 1.0));
    let request = feed.wait_request(PATIENCE).unwrap();
    assert!(feed.reject(&request, "below the ground"));
    assert_eq!(answer_line(&stream)["error"], "below the ground");
    // A packet that cannot be read gets a reply too.
    (&stream).write_all(b"{\"seq\":2}\n").unwrap();
    let answer = answer_line(&stream);
    assert_eq!(answer["seq"], serde_json::Value::Null);
    assert!(
        answer["error"].as_str().unwrap().contains("missing field"),
        "{answer}"
    );
}

#[test]
fn binary_frames_are_answered_in_binary_over_udp() {
    let (feed, address) = open(lockstep(udp()));
    let socket = UdpSocket::bind(loopback()).unwrap();
    socket.set_read_timeout(Some(PATIENCE)).unwrap();
    socket
        .send_to(&frame(77, 1.0).to_bytes().unwrap(), address)
        .unwrap();
    assert_eq!(draw(&feed, 1), [77]);
    let mut answer = [0; 600];
    let (length, from) = socket.recv_from(&mut answer).unwrap();
    assert_eq!((length, from), (20, address));
    assert_eq!(answer[..8], [0x89, b'T', b'R', b'L', 1, 3, 20, 0]);
    assert_eq!(answer[8..16], 77_u64.to_le_bytes());
}

#[test]
fn frames_are_answered_over_websocket() {
    use tungstenite::Message;
    let (feed, address) = open(lockstep(LiveOptions::new(Transport::WebSocket(loopback()))));
    let (mut socket, _) =
        tungstenite::client(format!("ws://{address}/"), connect(address)).unwrap();
    socket.send(Message::text(frame(1, 1.0).to_json())).unwrap();
    assert_eq!(draw(&feed, 1), [1]);
    assert_eq!(
        socket.read().unwrap().to_text().unwrap().trim_end(),
        r#"{"message":"ack","seq":1}"#
    );
    socket
        .send(Message::binary(frame(2, 2.0).to_bytes().unwrap().to_vec()))
        .unwrap();
    assert_eq!(draw(&feed, 1), [2]);
    let answer = socket.read().unwrap();
    assert!(answer.is_binary());
    assert_eq!(answer.into_data()[8..16], 2_u64.to_le_bytes());
}

#[test]
fn frames_come_and_answers_go_over_a_pipe() {
    let (read, mut simulator) = std::io::pipe().unwrap();
    let (answers, write) = std::io::pipe().unwrap();
    let feed = LiveFeed::from_stream(read, write, lockstep(tcp())).unwrap();
    let mut answers = BufReader::new(answers);
    for seq in 1..=3 {
        simulator
            .write_all(frame(seq, 1.0).to_json().as_bytes())
            .unwrap();
        assert_eq!(draw(&feed, 1), [seq]);
        let mut line = String::new();
        answers.read_line(&mut line).unwrap();
        assert_eq!(line, format!("{{\"message\":\"ack\",\"seq\":{seq}}}\n"));
    }
}

#[test]
fn a_simulator_that_is_gone_holds_nobody_up() {
    let (feed, address) = open(lockstep(tcp()));
    for seq in 1..=20 {
        // Asks for a frame and goes away.
        send_line(&connect(address), &frame(seq, 1.0));
    }
    let stream = connect(address);
    send_line(&stream, &frame(99, 2.0));
    let begun = Instant::now();
    let answered = std::thread::spawn(move || answer_line(&stream));
    while !answered.is_finished() {
        assert!(begun.elapsed() < PATIENCE, "{:?}", feed.counters());
        if let Some(request) = feed.wait_request(Duration::from_millis(10)) {
            feed.acknowledge(&request);
        }
    }
    assert_eq!(answered.join().unwrap()["seq"], 99);
    assert!(begun.elapsed() < Duration::from_secs(5));
}

/// Requests a frame by a line of JSON, draws it, and reads the reply.
fn ask_and_draw(feed: &LiveFeed, stream: &TcpStream, seq: u64) {
    send_line(stream, &frame(seq, seq as f64));
    assert_eq!(draw(feed, 1), [seq]);
    assert_eq!(answer_line(stream)["seq"], seq);
}

#[test]
fn connections_that_send_nothing_good_leave_a_simulator_alone() {
    for junk in [&b""[..], b"\n", b"{\"seq\":1}\n", b"\x89TRL nothing\n"] {
        let (feed, address) = open(lockstep(tcp()));
        let simulator = connect(address);
        ask_and_draw(&feed, &simulator, 1);
        // It computes its next state: between two frames it is as silent as they are.
        let mut others: Vec<_> = (0..6).map(|_| connect(address)).collect();
        others
            .iter_mut()
            .for_each(|other| other.write_all(junk).unwrap());
        until("all are accepted", || feed.counters().connections == 7);
        ask_and_draw(&feed, &simulator, 2);
        // It waits for its frame, and more come than are ever kept.
        send_line(&simulator, &frame(3, 3.0));
        let request = feed.wait_request(PATIENCE).unwrap();
        others.extend((0..20).map(|_| connect(address)));
        until("all are accepted", || feed.counters().connections == 27);
        assert!(feed.acknowledge(&request));
        assert_eq!(answer_line(&simulator)["seq"], 3);
        ask_and_draw(&feed, &simulator, 4);
    }
}

#[test]
fn who_waits_for_a_frame_is_not_dismissed_for_simulators_that_send() {
    let (feed, address) = open(lockstep(tcp()));
    let simulator = connect(address);
    send_line(&simulator, &frame(1, 1.0));
    let request = feed.wait_request(PATIENCE).unwrap();
    let mut others: Vec<_> = (0..6).map(|_| connect(address)).collect();
    others
        .iter()
        .for_each(|other| send_line(other, &packet(1, 2.0)));
    // Of those without a pending reply the one silent longest is dismissed.
    until("2 are dismissed", || feed.counters().rejected >= 2);
    assert!(feed.acknowledge(&request));
    assert_eq!(answer_line(&simulator)["seq"], 1);
    assert!(matches!(others[0].read(&mut [0]), Ok(0) | Err(_)));
}

#[test]
fn idle_connections_leave_a_simulator_over_websocket_alone() {
    use tungstenite::Message;
    let (feed, address) = open(lockstep(LiveOptions::new(Transport::WebSocket(loopback()))));
    let url = format!("ws://{address}/");
    let (mut simulator, _) = tungstenite::client(&url, connect(address)).unwrap();
    let mut ask = |seq| {
        let packet = frame(seq, seq as f64).to_json();
        simulator.send(Message::text(packet)).unwrap();
        assert_eq!(draw(&feed, 1), [seq]);
        let answer = simulator.read().unwrap();
        assert!(answer.to_text().unwrap().contains("ack"), "{answer}");
    };
    ask(1);
    let idle: Vec<_> = (0..6)
        .map(|_| tungstenite::client(&url, connect(address)).unwrap())
        .collect();
    let _not_even_greeted: Vec<_> = (0..6).map(|_| connect(address)).collect();
    ask(2);
    drop(idle);
    ask(3);
}

#[test]
fn a_frame_in_broadcast_is_rejected_and_says_why() {
    let (feed, address) = open(tcp());
    let stream = connect(address);
    send_line(&stream, &frame(1, 1.0));
    let answer = answer_line(&stream);
    assert!(
        answer["error"].as_str().unwrap().contains("broadcast"),
        "{answer}"
    );
    assert_eq!(feed.next_request(), None);
    assert_eq!(feed.counters().bad, 1);
}

/// Set for the child process only.
const CHILD: &str = "TERRELLA_TEST_LIVE_CHILD";

#[test]
#[ignore = "the other side of frames_come_on_standard_input, which starts it"]
fn child_on_standard_input() {
    if std::env::var_os(CHILD).is_none() {
        eprintln!("SKIPPED: it is no child of frames_come_on_standard_input");
        return;
    }
    let feed = LiveFeed::open(lockstep(LiveOptions::new(Transport::Stdin))).unwrap();
    assert_eq!(feed.local_address(), None);
    draw(&feed, 2);
    until("2 answers", || feed.counters().drawn == 2);
}

#[test]
fn frames_come_on_standard_input() {
    use std::process::{Command, Stdio};
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--ignored",
            "--exact",
            "--nocapture",
            "lockstep::child_on_standard_input",
        ])
        .env(CHILD, "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut simulator = child.stdin.take().unwrap();
    // Output of the test itself comes before the replies.
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines();
    for seq in 1..=2 {
        simulator
            .write_all(frame(seq, 1.0).to_json().as_bytes())
            .unwrap();
        let ack = format!("{{\"message\":\"ack\",\"seq\":{seq}}}");
        assert!(
            answers.any(|line| line.unwrap().ends_with(&ack)),
            "no {ack}"
        );
    }
    // Its input stays open: the feed's thread must not hold the process.
    assert!(child.wait().unwrap().success());
}

#[test]
fn whoever_waits_when_the_feed_ends_is_reported_so() {
    for transport in ["tcp", "udp", "pipe"] {
        let (read, mut pipe) = std::io::pipe().unwrap();
        let (mut answers, write) = std::io::pipe().unwrap();
        let asked = frame(7, 1.0).to_json();
        let feed = match transport {
            "tcp" => open(lockstep(tcp())).0,
            "udp" => open(lockstep(udp())).0,
            _ => LiveFeed::from_stream(read, write, lockstep(tcp())).unwrap(),
        };
        let stream = (transport == "tcp").then(|| connect(feed.local_address().unwrap()));
        let socket = UdpSocket::bind(loopback()).unwrap();
        socket.set_read_timeout(Some(PATIENCE)).unwrap();
        match (transport, &stream) {
            ("tcp", Some(stream)) => send_line(stream, &frame(7, 1.0)),
            ("udp", _) => drop(socket.send_to(asked.as_bytes(), feed.local_address().unwrap())),
            _ => pipe.write_all(asked.as_bytes()).unwrap(),
        }
        feed.wait_request(PATIENCE).unwrap();
        let begun = Instant::now();
        drop(feed);
        assert!(
            begun.elapsed() < Duration::from_secs(2),
            "{:?}",
            begun.elapsed()
        );
        let mut bytes = [0; 600];
        let length = match (transport, stream) {
            ("tcp", Some(mut stream)) => stream.read(&mut bytes).unwrap(),
            ("udp", _) => socket.recv(&mut bytes).unwrap(),
            _ => answers.read(&mut bytes).unwrap(),
        };
        let reported = String::from_utf8_lossy(&bytes[..length]);
        assert!(
            reported.contains("the feed is closed"),
            "{transport}: {reported:?}"
        );
    }
}
