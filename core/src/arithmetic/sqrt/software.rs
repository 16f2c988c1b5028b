//! Square roots by integer arithmetic alone.
//!
//! The significand is scaled to an integer `n` with an even number of digit pairs whose root has
//! one bit more than the format. That bit decides the rounding: `n` is even, the square of an odd
//! root is odd, so a root whose last bit is set is never exact and lies above the midpoint.

macro_rules! software_sqrt {
    ($(#[$doc:meta])* $name:ident, $float:ident, $bits:ident, $significand:expr, $bias:expr) => {
        $(#[$doc])*
        #[allow(dead_code)]
        pub(in crate::arithmetic) fn $name(x: $float) -> $float {
            // Significand bits including the hidden one, and the same count plus the guard bit.
            const SIGNIFICAND: u32 = $significand;
            const ROOT: u32 = SIGNIFICAND + 1;
            const HIDDEN: $bits = 1 << (SIGNIFICAND - 1);
            const INFINITY: $bits = $float::INFINITY.to_bits();

            let bits = x.to_bits();
            if bits << 1 == 0 || bits == INFINITY {
                return x;
            }
            if bits > INFINITY {
                return $float::NAN;
            }
            // x = significand 2^exponent, the significand with its hidden bit in place.
            let mut significand = bits & (HIDDEN - 1);
            let mut exponent = (bits >> (SIGNIFICAND - 1)) as i32;
            if exponent == 0 {
                let shift = significand.leading_zeros() - ($bits::BITS - SIGNIFICAND);
                significand <<= shift;
                exponent = 1 - shift as i32;
            } else {
                significand |= HIDDEN;
            }
            exponent -= $bias + SIGNIFICAND as i32 - 1;
            // n = significand 2^ROOT: the exponent that is left must be even.
            if (exponent - ROOT as i32) & 1 != 0 {
                significand <<= 1;
                exponent -= 1;
            }
            let mut digits = significand << ($bits::BITS - ROOT);
            let mut remainder: $bits = 0;
            let mut root: $bits = 0;
            for _ in 0..ROOT {
                remainder = remainder << 2 | digits >> ($bits::BITS - 2);
                digits <<= 2;
                let trial = root << 2 | 1;
                root <<= 1;
                if remainder >= trial {
                    remainder -= trial;
                    root |= 1;
                }
            }
            let exponent = (exponent - ROOT as i32) / 2 + 1 + $bias + SIGNIFICAND as i32 - 1;
            // The hidden bit adds one to the exponent field, and a carry out of the rounding
            // another.
            let rounded = (root + 1) >> 1;
            $float::from_bits((((exponent - 1) as $bits) << (SIGNIFICAND - 1)) + rounded)
        }
    };
}

software_sqrt! {
    /// Correctly rounded root of an `f32`.
    sqrt_f32, f32, u32, 24, 127
}
software_sqrt! {
    /// Correctly rounded root of an `f64`.
    sqrt_f64, f64, u64, 53, 1023
}
