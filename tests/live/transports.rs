//! Sent states arrive, to the last bit, over every transport and in both formats.

use super::*;
use std::net::UdpSocket;
use terrella_orbit::live::LiveError;
use terrella_orbit::{Feed, Freshness};

#[test]
fn states_come_over_tcp_in_both_forms_mixed() {
    let (feed, address) = open(tcp());
    assert_eq!(feed.freshness(), Freshness::Waiting);
    let error = feed.state_at(at(0.0)).unwrap_err().to_string();
    assert!(
        error.contains(&format!("no state has arrived on tcp://{address}")),
        "{error}"
    );
    let stream = connect(address);
    for seq in 0..20 {
        let packet = packet(seq, seq as f64);
        match seq % 2 {
            0 => send_line(&stream, &packet),
            _ => (&stream).write_all(&packet.to_bytes().unwrap()).unwrap(),
        }
    }
    until("20 states", || feed.counters().taken == 20);
    for seq in 0..20 {
        assert_eq!(
            feed.state_at(at(f64::from(seq))).unwrap(),
            state(f64::from(seq))
        );
    }
    assert_eq!(feed.freshness(), Freshness::Live);
    assert_eq!((feed.counters().bad, feed.counters().connections), (0, 1));
    assert_eq!(feed.name(), "live");
    assert_eq!(feed.validity(), (at(0.0), at(79.0)));
}

#[test]
fn states_come_byte_by_byte() {
    let (feed, address) = open(tcp());
    let mut stream = connect(address);
    stream.set_nodelay(true).unwrap();
    let mut named = packet(1, 1.0);
    named.name = Some("Sonde Ä".to_owned());
    let mut bytes = named.to_json().into_bytes();
    bytes.extend(packet(2, 2.0).to_bytes().unwrap());
    for byte in bytes {
        stream.write_all(&[byte]).unwrap();
    }
    until("2 states", || feed.counters().taken == 2);
    assert_eq!(feed.counters().bad, 0);
    assert_eq!(feed.name(), "Sonde Ä");
}

#[test]
fn states_come_over_udp_in_both_forms() {
    let (feed, address) = open(udp());
    let socket = UdpSocket::bind(loopback()).unwrap();
    socket
        .send_to(&packet(1, 1.0).to_bytes().unwrap(), address)
        .unwrap();
    let lines = packet(2, 2.0).to_json() + &packet(3, 3.0).to_json();
    socket
        .send_to(lines.trim_end().as_bytes(), address)
        .unwrap();
    // Longer than a packet may be, and half a packet: neither leaves anything behind.
    socket.send_to(&[b'{'; 5000], address).unwrap();
    socket
        .send_to(&packet(4, 4.0).to_bytes().unwrap()[..50], address)
        .unwrap();
    socket
        .send_to(&packet(5, 5.0).to_bytes().unwrap(), address)
        .unwrap();
    until("4 states", || feed.counters().taken == 4);
    // A line feed among the bytes of the half one begins another bad one.
    let bad = feed.counters().bad;
    assert!((2..=3).contains(&bad), "{bad}: {:?}", feed.last_fault());
    assert_eq!(feed.counters().lost, 1);
    assert_eq!(feed.state_at(at(5.0)).unwrap(), state(5.0));
}

#[test]
fn states_come_from_a_stream_and_its_end_is_not_the_feeds() {
    let lines = packet(1, 1.0).to_json() + "\r\n\n" + packet(2, 2.0).to_json().trim_end();
    let read = std::io::Cursor::new(lines.into_bytes());
    let feed = LiveFeed::from_stream(read, std::io::sink(), tcp()).unwrap();
    until("2 states", || feed.counters().taken == 2);
    assert_eq!(feed.local_address(), None);
    assert_eq!(feed.state_at(at(1.0)).unwrap(), state(1.0));
}

#[test]
fn states_come_over_websocket_and_web_pages_are_rejected() {
    use tungstenite::Message;
    use tungstenite::client::IntoClientRequest;
    let options = LiveOptions {
        allowed_origins: vec!["https://example.org".to_owned()],
        ..LiveOptions::new(Transport::WebSocket(loopback()))
    };
    let (feed, address) = open(options);
    let url = format!("ws://{address}/");
    let from = |origin: Option<&str>| {
        let mut request = url.as_str().into_client_request().unwrap();
        if let Some(origin) = origin {
            request
                .headers_mut()
                .insert("Origin", origin.parse().unwrap());
        }
        tungstenite::client(request, connect(address)).map_err(|e| e.to_string())
    };
    let (mut socket, _) = from(None).unwrap();
    socket
        .send(Message::text(packet(1, 1.0).to_json()))
        .unwrap();
    socket
        .send(Message::binary(packet(2, 2.0).to_bytes().unwrap().to_vec()))
        .unwrap();
    until("2 states", || feed.counters().taken == 2);
    assert_eq!(feed.counters().bad, 0, "{:?}", feed.last_fault());
    let rejected = from(Some("https://evil.example")).unwrap_err();
    assert!(rejected.contains("403"), "{rejected}");
    let (mut allowed, _) = from(Some("https://example.org")).unwrap();
    allowed
        .send(Message::text(packet(3, 3.0).to_json()))
        .unwrap();
    until("3 states", || feed.counters().taken == 3);
    // Too long a message ends its connection, not the feed.
    let _ = allowed.send(Message::binary(vec![0; 100_000]));
    until("a bad one", || feed.counters().bad == 1);
    socket
        .send(Message::text(packet(4, 4.0).to_json()))
        .unwrap();
    until("4 states", || feed.counters().taken == 4);
}

#[test]
fn other_machines_are_let_in_only_where_allowed() {
    let everywhere = SocketAddr::from(([0, 0, 0, 0], 0));
    for transport in [
        Transport::Tcp(everywhere),
        Transport::Udp(everywhere),
        Transport::WebSocket(everywhere),
        Transport::Tcp("[::]:0".parse().unwrap()),
        Transport::Udp("192.0.2.1:9".parse().unwrap()),
    ] {
        let error = LiveFeed::open(LiveOptions::new(transport)).unwrap_err();
        assert!(matches!(error, LiveError::NotLoopback { .. }), "{error}");
        assert!(error.to_string().contains("127.0.0.1"), "{error}");
    }
    let (feed, address) = open(LiveOptions {
        allow_remote: true,
        ..LiveOptions::new(Transport::Tcp(everywhere))
    });
    send_line(
        &connect((loopback().ip(), address.port()).into()),
        &packet(1, 1.0),
    );
    until("1 state", || feed.counters().taken == 1);
}

#[test]
fn settings_and_ports_that_cannot_be_are_rejected() {
    let (_feed, address) = open(tcp());
    let taken = LiveFeed::open(LiveOptions::new(Transport::Tcp(address))).unwrap_err();
    assert!(matches!(taken, LiveError::Bind { .. }), "{taken}");
    for (key, options) in [
        (
            "rate",
            LiveOptions {
                rate: f64::NAN,
                ..tcp()
            },
        ),
        (
            "playback_delay_s",
            LiveOptions {
                playback_delay_s: -1.0,
                ..tcp()
            },
        ),
        (
            "stale_after_s",
            LiveOptions {
                stale_after_s: 0.0,
                ..tcp()
            },
        ),
        (
            "extrapolation_limit_s",
            LiveOptions {
                extrapolation_limit_s: f64::INFINITY,
                ..tcp()
            },
        ),
        (
            "gap_s",
            LiveOptions {
                gap_s: 0.0,
                ..tcp()
            },
        ),
        (
            "frame_timeout",
            LiveOptions {
                frame_timeout: Duration::ZERO,
                ..tcp()
            },
        ),
        (
            "max_packets_per_s",
            LiveOptions {
                max_packets_per_s: 0,
                ..tcp()
            },
        ),
    ] {
        let error = LiveFeed::open(options).unwrap_err().to_string();
        assert!(
            error.starts_with(key) && error.contains("expected"),
            "{error}"
        );
    }
}

#[test]
fn a_feed_that_is_dropped_frees_its_port_at_once() {
    for options in [tcp(), udp(), lockstep(tcp())] {
        let (feed, address) = open(options.clone());
        let kept = matches!(options.transport, Transport::Tcp(_)).then(|| connect(address));
        if let Some(stream) = &kept {
            // In lockstep it waits for an image that will not be drawn.
            send_line(stream, &frame(1, 1.0));
            std::thread::sleep(Duration::from_millis(50));
        }
        let begun = Instant::now();
        drop(feed);
        assert!(
            begun.elapsed() < Duration::from_secs(2),
            "{:?}",
            begun.elapsed()
        );
        if kept.is_some() {
            assert!(TcpStream::connect(address).is_err());
        }
    }
}

#[test]
fn what_is_listened_on_is_written_and_read() {
    for text in [
        "stdin",
        "tcp://127.0.0.1:5005",
        "udp://[::1]:5005",
        "ws://0.0.0.0:0",
    ] {
        let transport: Transport = text.parse().unwrap();
        assert_eq!(transport.to_string(), text);
    }
    let named: Transport = "tcp://localhost:7".parse().unwrap();
    assert_eq!(named.to_string(), "tcp://127.0.0.1:7");
    for text in [
        "",
        "tcp",
        "tcp://",
        "tcp://127.0.0.1",
        "http://127.0.0.1:5",
        "tcp://127.0.0.1:70000",
    ] {
        let error = text.parse::<Transport>().unwrap_err().to_string();
        assert!(error.contains("\"tcp://127.0.0.1:5005\""), "{error}");
    }
    let collide = |a: &str, b: &str| {
        let [a, b]: [Transport; 2] = [a, b].map(|text| text.parse().unwrap());
        assert_eq!(a.collides_with(&b), b.collides_with(&a));
        a.collides_with(&b)
    };
    assert!(collide("stdin", "stdin"));
    assert!(collide("tcp://127.0.0.1:5", "ws://0.0.0.0:5"));
    assert!(!collide("tcp://127.0.0.1:5", "udp://127.0.0.1:5"));
    assert!(!collide("tcp://127.0.0.1:5", "tcp://127.0.0.2:5"));
    assert!(!collide("tcp://127.0.0.1:0", "tcp://127.0.0.1:0"));
    assert!(!collide("stdin", "tcp://127.0.0.1:0"));
}
