//! Scripted rigid motion of obstacles and grips.

use glam::{DQuat, DVec3};

/// Where a rigid thing is: a rotation about the motion's pivot, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation about the pivot.
    pub rotation: DQuat,
    /// Translation \[m\].
    pub translation: DVec3,
}

/// One key of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Time \[s\].
    pub time: f64,
    /// Rotation vector (axis times angle \[rad\]) about the pivot.
    pub rotation: DVec3,
    /// Translation from the initial place \[m\].
    pub translation: DVec3,
}

/// Piecewise linear scripted motion; still before the first key and after the last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// Keys in order of time; none means still at the initial place.
    pub keys: Vec<Key>,
    /// Point that rotations turn about \[m\].
    pub pivot: DVec3,
}

impl Motion {
    /// The pose at a time \[s\].
    #[must_use]
    pub fn pose(&self, time: f64) -> Pose {
        let (rotation, translation) = match self.keys.iter().position(|key| key.time > time) {
            None => self.keys.last().map_or((DVec3::ZERO, DVec3::ZERO), |key| (key.rotation, key.translation)),
            Some(0) => (self.keys[0].rotation, self.keys[0].translation),
            Some(i) => {
                let (a, b) = (&self.keys[i - 1], &self.keys[i]);
                let s = (time - a.time) / (b.time - a.time);
                (a.rotation.lerp(b.rotation, s), a.translation.lerp(b.translation, s))
            }
        };
        Pose { rotation: DQuat::from_scaled_axis(rotation), translation }
    }

    /// Where a point that starts at `point` is at a time.
    #[must_use]
    pub fn place(&self, point: DVec3, time: f64) -> DVec3 {
        let pose = self.pose(time);
        self.pivot + pose.rotation * (point - self.pivot) + pose.translation
    }
}
