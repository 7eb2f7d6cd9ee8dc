//! The frame rate that the rounded delays of a GIF stand for.
use std::io::{Read, Seek};

/// Unit of the delays of a GIF, in seconds.
const UNIT: f64 = 0.01;

/// Seconds from frame to frame of a GIF whose delays are those of a constant rate, rounded to whole hundredths of a second
/// one after the other; `None` where they are equal, or are no such delays. Leaves the source at its beginning.
///
/// Taken as they stand, such delays put a frame up to 5 ms off its time: an object that crosses the picture in a second
/// then seems to jump by several times the noise of its outline.
pub(crate) fn constant_interval(source: &mut (impl Read + Seek)) -> std::io::Result<Option<f64>> {
    let delays = delays(&mut *source);
    source.rewind()?;
    // How long the last frame stands says nothing of the rate.
    Ok(delays.split_last().and_then(|(_, delays)| rounded_interval(delays)))
}

fn delays(source: impl Read) -> Vec<u16> {
    let mut options = gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    let mut delays = Vec::new();
    let Ok(mut decoder) = options.read_info(source) else { return delays };
    while let Ok(Some(frame)) = decoder.next_frame_info() {
        delays.push(frame.delay);
    }
    delays
}

fn rounded_interval(delays: &[u16]) -> Option<f64> {
    let (shortest, longest) = (delays.iter().min()?, delays.iter().max()?);
    if *shortest == 0 || longest - shortest != 1 {
        return None;
    }
    let total: u64 = delays.iter().map(|delay| u64::from(*delay)).sum();
    let interval = total as f64 / delays.len() as f64;
    let mut time = 0;
    let is_even = (1_u64..).zip(delays).all(|(count, delay)| {
        time += u64::from(*delay);
        (time as f64 - count as f64 * interval).abs() <= 1.0
    });
    is_even.then_some(interval * UNIT)
}

#[cfg(test)]
mod tests {
    use super::rounded_interval;

    #[test]
    fn delays_of_a_rate_that_hundredths_cannot_tell_give_the_rate() {
        for rate in [15.0, 24.0, 29.97, 60.0] {
            let at = |frame: usize| (100.0 * frame as f64 / rate).round() as u16;
            let delays: Vec<u16> = (0..200).map(|frame| at(frame + 1) - at(frame)).collect();
            let interval = rounded_interval(&delays).expect("a constant rate");
            assert!((interval * rate - 1.0).abs() < 2e-3, "{rate}: {interval}");
        }
    }

    #[test]
    fn other_delays_stand_as_they_are() {
        for delays in [&[][..], &[4, 4, 4], &[4, 0, 4, 5], &[3, 5, 4, 4], &[6, 6, 6, 6, 6, 6, 7, 7, 7, 7, 7, 7]] {
            assert_eq!(rounded_interval(delays), None, "{delays:?}");
        }
    }
}
