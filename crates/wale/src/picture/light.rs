//! What light makes of a surface: one warm lamp, light from all around, a faint light from the eye.

use glam::Vec3;

/// Strength of the key light on a surface that faces it.
pub(super) const KEY: f32 = 0.97;
/// Colour of the key light: a little warm.
const KEY_COLOR: Vec3 = Vec3::new(1.0, 0.965, 0.91);
/// Light from above and from below, where nothing stands near.
const SKY: Vec3 = Vec3::new(0.56, 0.60, 0.67);
const BOUNCE: Vec3 = Vec3::new(0.43, 0.40, 0.37);
/// Part of it that arrives in the deepest corner: fibres let light through.
const SEEP: f32 = 0.14;
/// Light from the eye.
const FILL: f32 = 0.17;

/// Where light comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Light {
    /// Unit vector to the lamp.
    pub to_key: Vec3,
    /// Unit vector to the side from which most of the light from all around comes.
    pub up: Vec3,
}

impl Light {
    /// Light that a rough, slightly hairy surface sends to the eye.
    ///
    /// `normals` are the surface's own and that of its coarse form: the edge that hair brightens is the form's.
    /// `key` and `open` are the parts of the lamp and of the light from all around that arrive.
    pub fn surface(&self, color: Vec3, normals: [Vec3; 2], to_eye: Vec3, key: f32, open: f32) -> Vec3 {
        let [normal, form] = normals;
        let open = SEEP + (1.0 - SEEP) * open;
        let wrap = 0.18;
        let facing = ((normal.dot(self.to_key) + wrap) / (1.0 + wrap)).max(0.0);
        let above = 0.5 + 0.5 * normal.dot(self.up);
        // Light that is stopped nearby comes back in the stopper's colour, which is most often this one.
        let around = Vec3::splat(open) / (Vec3::ONE - color.min(Vec3::splat(0.9)) * (1.0 - open));
        let ambient = BOUNCE.lerp(SKY, above) * around;
        let eye = normal.dot(to_eye).max(0.0);
        let edge = 1.0 - form.dot(to_eye).max(0.0);
        let rim = edge.powi(3) * (0.25 * ambient + 0.22 * key * facing);
        let hair = color.lerp(Vec3::ONE, 0.35);
        color * (KEY * KEY_COLOR * facing * key + ambient + FILL * eye) + hair * rim
    }
}

/// Leaves light below 0.8 as it is and bends what is above towards 1.
pub(super) fn shoulder(light: Vec3) -> Vec3 {
    let one = |x: f32| {
        if x <= 0.8 { x } else { 0.8 + 0.2 * (1.0 - (-(x - 0.8) / 0.2).exp()) }
    };
    Vec3::new(one(light.x), one(light.y), one(light.z))
}

/// The light that [`shoulder`] turns into the one given.
pub(super) fn before_shoulder(light: Vec3) -> Vec3 {
    light.map(|y| if y <= 0.8 { y } else { 0.8 - 0.2 * (1.0 - (y.min(0.9999) - 0.8) / 0.2).ln() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shoulder_rises_to_one_and_can_be_undone() {
        let mut last = -1.0;
        for i in 0..100 {
            let x = 0.03 * i as f32;
            let y = shoulder(Vec3::splat(x)).x;
            assert!(y > last && y < 1.0);
            last = y;
            if y < 0.99 {
                assert!((before_shoulder(Vec3::splat(y)).x - x).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn a_surface_is_brighter_towards_the_lamp_and_darker_when_hidden() {
        let light = Light { to_key: Vec3::new(-0.6, 0.6, 0.53).normalize(), up: Vec3::Y };
        let at = |normal: Vec3, key: f32, open: f32| {
            light.surface(Vec3::splat(0.5), [normal; 2], Vec3::Z, key, open).element_sum()
        };
        let tilted = Vec3::new(0.6, -0.6, 0.53).normalize();
        assert!(at(light.to_key, 1.0, 1.0) > 1.5 * at(tilted, 1.0, 1.0));
        assert!(at(Vec3::Z, 1.0, 1.0) > at(Vec3::Z, 0.0, 1.0));
        assert!(at(Vec3::Z, 0.0, 1.0) > 1.4 * at(Vec3::Z, 0.0, 0.1));
    }
}
