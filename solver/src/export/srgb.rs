//! Bytes of sRGB (IEC 61966-2-1) and linear intensities.

/// The linear intensity of a byte \[-\].
#[must_use]
pub fn to_linear(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The nearest byte of a linear intensity \[-\].
#[must_use]
pub fn of_linear(intensity: f32) -> u8 {
    let value = if intensity <= 0.003_130_8 {
        12.92 * intensity
    } else {
        1.055 * intensity.powf(1.0 / 2.4) - 0.055
    };
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_comes_back() {
        assert!((0..=255).all(|byte| of_linear(to_linear(byte)) == byte));
        // Half of the light is 188 of 255.
        assert_eq!([-1.0, 0.0, 0.5, 1.0, 2.0].map(of_linear), [0, 0, 188, 255, 255]);
    }
}
