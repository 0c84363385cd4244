//! The compressions of a stack that answer best for what its yarns are pulled by.

/// Most yarns of a stack.
pub const MOST_YARNS: usize = 8;

/// The non-negative `λ` of `min Σ (f_i − λ_i + λ_{i−1})²`: of all sets of contacts that may be open the one that is
/// consistent and leaves least.
pub fn stack_compressions(pulled: &[f64], lambda: &mut [f64]) {
    let contacts = lambda.len();
    let mut best = f64::INFINITY;
    lambda.fill(0.0);
    for closed in 0..1u32 << contacts {
        let mut trial = [0.0; MOST_YARNS];
        let mut first = 0;
        // Closed contacts in a row press a group of yarns that shares what is left evenly.
        while first <= contacts {
            let mut last = first;
            while last < contacts && closed >> last & 1 == 1 {
                last += 1;
            }
            let group = &pulled[first..=last];
            let mean = group.iter().sum::<f64>() / group.len() as f64;
            let mut pressed = 0.0;
            for k in first..last {
                pressed += pulled[k] - mean;
                trial[k] = pressed;
            }
            first = last + 1;
        }
        let left: f64 = (0..=contacts)
            .map(|i| {
                let (own, before) = (if i < contacts { trial[i] } else { 0.0 }, if i > 0 { trial[i - 1] } else { 0.0 });
                (pulled[i] - own + before).powi(2)
            })
            .sum();
        if trial[..contacts].iter().all(|&l| l >= 0.0) && left < best {
            best = left;
            lambda.copy_from_slice(&trial[..contacts]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stacks_press_by_least_squares() {
        let press = |pulled: &[f64]| {
            let mut lambda = vec![0.0; pulled.len() - 1];
            stack_compressions(pulled, &mut lambda);
            lambda
        };
        assert_eq!(press(&[2.0, -4.0]), [3.0]);
        let three = press(&[4.0, 0.0, -2.0]);
        assert!((three[0] - 10.0 / 3.0).abs() < 1e-12 && (three[1] - 8.0 / 3.0).abs() < 1e-12);
        // Eq. 4 of the paper gives 8/3 and 4/3 here.
        assert_eq!(press(&[4.0, 0.0, 2.0]), [2.0, 0.0]);
        assert_eq!(press(&[-1.0, 1.0]), [0.0]);
        // Against all directions: what is left cannot be lessened by any non-negative change.
        let pulled = [3.0, -1.0, 0.5, -2.0];
        let lambda = press(&pulled);
        let left = |i: usize| pulled[i] - if i < 3 { lambda[i] } else { 0.0 } + if i > 0 { lambda[i - 1] } else { 0.0 };
        for (k, &pressed) in lambda.iter().enumerate() {
            let slope = left(k + 1) - left(k);
            assert!(slope > -1e-12 && (pressed * slope).abs() < 1e-12, "contact {k}");
        }
    }
}
