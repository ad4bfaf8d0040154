//! Sentences of NMEA 0183, with the numbers their sources give.

use super::{FORMS, Form, Piece, STAMP_NS, decoder, header};
use crate::read::messages::content::{Body, Nmea, Sentence};

const KNOT: f64 = 0.514_444_444_444_444_4;

/// A sentence with its checksum.
fn summed(data: &str) -> String {
    let sum = data.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${data}*{sum:02X}")
}

/// What a text in a `nmea_msgs/Sentence` says.
fn read(text: &str) -> Result<Option<Nmea>, String> {
    let mut said = Vec::new();
    for form in FORMS {
        let message = form.write(&[header("gps"), Piece::Text(text.to_owned())]);
        let decoder = decoder("/serial", "nmea_msgs/Sentence", form, "");
        let content = decoder.decode(&message).map_err(|error| error.0);
        said.push(content.map(|content| {
            assert_eq!(content.header.unwrap().stamp_ns, STAMP_NS);
            match content.body {
                Body::Nmea(nmea) => Some(*nmea),
                Body::Nothing => None,
                other => panic!("{other:?}"),
            }
        }));
    }
    // In ROS 1 other bytes come first: only the place of an error may differ.
    assert_eq!(said[0], said[1]);
    assert_eq!(said[0].as_ref().ok(), said[2].as_ref().ok());
    said.swap_remove(0)
}

fn said(data: &str) -> Nmea {
    read(&summed(data)).unwrap().unwrap()
}

fn silent(sentence: Sentence) -> Nmea {
    Nmea {
        sentence,
        time_s: None,
        position: None,
        altitude_m: None,
        geoid_separation_m: None,
        quality: None,
        speed_m_s: None,
        course_deg: None,
        true_heading_deg: None,
        magnetic_heading_deg: None,
        variation_deg: None,
    }
}

#[track_caller]
fn close(value: Option<f64>, expected: f64) {
    assert!(
        value.is_some_and(|value| (value - expected).abs() < 1e-9),
        "{value:?} {expected}"
    );
}

#[test]
fn positions_stand_in_gga_and_gns() {
    // The example of the NMEA FAQ (Peter Bennett), whole.
    let gga = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
    let nmea = read(gga).unwrap().unwrap();
    let [latitude, longitude] = nmea.position.unwrap();
    close(Some(latitude), 48.0 + 7.038 / 60.0);
    close(Some(longitude), 11.0 + 31.0 / 60.0);
    close(nmea.time_s, 12.0 * 3600.0 + 35.0 * 60.0 + 19.0);
    assert_eq!((nmea.altitude_m, nmea.geoid_separation_m), (Some(545.4), Some(46.9)));
    assert_eq!((nmea.sentence, nmea.quality), (Sentence::Gga, Some(1)));

    let south_west = said("GNGNS,103600.01,5114.51176,S,00012.29380,W,NRNN,07,1.18,111.5,45.6,,,V");
    let [latitude, longitude] = south_west.position.unwrap();
    close(Some(latitude), -(51.0 + 14.51176 / 60.0));
    close(Some(longitude), -12.2938 / 60.0);
    close(south_west.time_s, 38_160.01);
    assert_eq!(
        (south_west.altitude_m, south_west.geoid_separation_m),
        (Some(111.5), Some(45.6))
    );
    assert_eq!(south_west.quality, Some(4));

    let nothing = |sentence| Nmea {
        quality: Some(0),
        ..silent(sentence)
    };
    assert_eq!(said("GPGGA,,,,,,0,,,,M,,M,,"), nothing(Sentence::Gga));
    assert_eq!(said("GNGNS,,,,,,NNN,,,,,,"), nothing(Sentence::Gns));
    assert_eq!(said("GPGGA,"), silent(Sentence::Gga));
    assert_eq!(
        said("GPGGA,115739.00,4158.8,N,09147.4,W,9,13,0.9,255.7,M,,M,,").quality,
        Some(9)
    );
}

#[test]
fn motion_stands_in_rmc_and_vtg() {
    // The same source.
    let rmc = read("$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A")
        .unwrap()
        .unwrap();
    close(rmc.speed_m_s, 22.4 * KNOT);
    close(rmc.course_deg, 84.4);
    close(rmc.variation_deg, -3.1);
    assert_eq!((rmc.quality, rmc.position.is_some()), (Some(1), true));
    assert_eq!(
        said("GNRMC,123519,A,4807.038,N,01131.000,E,0.0,,230394,,,R").quality,
        Some(4)
    );
    assert_eq!(
        said("GNRMC,123519,V,4807.038,N,01131.000,E,0.0,,230394,,,A").quality,
        Some(0)
    );

    let vtg = read("$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K*48").unwrap().unwrap();
    close(vtg.speed_m_s, 5.5 * KNOT);
    close(vtg.course_deg, 54.7);
    close(said("GPVTG,85.7,T,,M,,N,36.0,K,D").speed_m_s, 10.0);
    assert_eq!(
        said("GPVTG,,T,,M,,N,,K,N"),
        Nmea {
            quality: Some(0),
            ..silent(Sentence::Vtg)
        }
    );
}

#[test]
fn headings_tell_true_from_magnetic_north() {
    close(said("GPHDT,274.07,T").true_heading_deg, 274.07);
    close(said("HCHDM,238.5,M").magnetic_heading_deg, 238.5);
    let hdg = said("HCHDG,359.0,2.5,E,12.6,W");
    close(hdg.magnetic_heading_deg, 1.5);
    close(hdg.variation_deg, -12.6);
    assert_eq!(hdg.true_heading_deg, None);
    close(said("HCHDG,101.1,,,7.1,W").magnetic_heading_deg, 101.1);
}

#[test]
fn other_sentences_and_other_texts_say_nothing() {
    for text in [
        "",
        "hello",
        "$",
        "$GP",
        "$VNYMR,1,2,3*00",
        "$PASHR,1,2",
        "$PUGGA,1",
        "!AIVDM,1,1,,A,x,0*00",
        "$GPGSV,1,1,00*79",
        "$ÄGGA,1*00",
        "GPGGA,1*00",
    ] {
        assert_eq!(read(text), Ok(None), "{text}");
    }
}

#[test]
fn broken_sentences_are_errors_with_the_byte() {
    let error = |text: &str| read(text).unwrap_err();
    // The sentence begins behind the encapsulation, a header of 16 bytes and the text's length.
    assert_eq!(error("$GPHDT,274.07,T"), "the NMEA sentence at byte 24 has no checksum");
    let wrong = "the NMEA sentence at byte 26 has a wrong checksum; it should be 03";
    assert_eq!(error("\r\n$GPHDT,274.07,T*04"), wrong);
    for tail in ["*3", "*003", "*+3", "*\u{e4}", "*", "*03$GPHDT,274.07,T*03"] {
        let text = format!("$GPHDT,274.07,T{tail}");
        assert!(error(&text).contains("checksum"), "{text}");
    }
    let fault = |data: &str| error(&summed(data));
    let of = |number, at, what| format!("field {number} of an NMEA sentence, at byte {at}, is not {what}");
    assert_eq!(fault("GPHDT,north,T"), of(1, 31, "a number"));
    for number in ["inf", "NaN", "1e3", "1.2.3", "-", "."] {
        assert_eq!(fault(&format!("GPHDT,{number},T")), of(1, 31, "a number"), "{number}");
    }
    assert_eq!(fault("GPGGA,,4807.0,N,18131.0,E,1"), of(4, 41, "a longitude"));
    assert_eq!(fault("GPGGA,,9001.0,N,01131.0,E,1"), of(2, 32, "a latitude"));
    assert_eq!(fault("GPGGA,,4860.0,N,01131.0,E,1"), of(2, 32, "a latitude"));
    assert_eq!(fault("GPGGA,,4807.0,X,01131.0,E,1"), of(3, 39, "`N` or `S`"));
    assert_eq!(fault("GPGGA,246000,,,,,1"), of(1, 31, "a time"));
    assert_eq!(fault("GPGGA,,,,,,12"), of(6, 36, "a digit"));
    assert_eq!(fault("GPGGA,,,,,,1,,,5.0,F"), of(10, 44, "the unit `M`"));
    assert_eq!(fault("GPVTG,,T,,M,,N,,K,x"), of(9, 43, "a mode"));
    assert!(read(&summed(&format!("GPGGA{}", ",".repeat(100_000)))).is_ok());
}

#[test]
fn texts_on_topics_called_nmea_are_sentences() {
    let text = summed("GPHDT,274.07,T");
    for form in FORMS {
        let message = form.write(&[Piece::Text(text.clone())]);
        for (topic, is_read) in [
            ("/nmea", true),
            ("/gps/NMEA_sentence", true),
            ("/nmea/raw", false),
            ("/chatter", false),
        ] {
            let content = decoder(topic, "std_msgs/msg/String", form, "")
                .decode(&message)
                .unwrap();
            assert_eq!(matches!(content.body, Body::Nmea(_)), is_read, "{topic}");
            assert_eq!(content.header, None);
        }
        let other = form.write(&[Piece::Text("ready".to_owned())]);
        let content = decoder("/nmea", "std_msgs/String", form, "").decode(&other).unwrap();
        assert_eq!(content.body, Body::Nothing);
    }
    assert!(
        decoder("/nmea", "std_msgs/String", Form::Ros1, "")
            .decode(&[9, 0, 0, 0])
            .is_err()
    );
}
