//! From yarns and obstacles to pixels: rays, light, shadow.
//!
//! One key light with a soft shadow, light from all around dimmed by what stands near, and a faint light from the eye.
//! All "random" numbers follow from the pixel, so a picture has the same bits on any number of threads.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    Camera, Image, Settings, Subject,
    bvh::Ray,
    color_map::{to_linear, to_srgb},
    hair::hairs,
    light::{KEY, Light, before_shoulder, shoulder},
    sampling::{Dice, plastic, tent},
    scale_bar::{draw_caption, draw_legend, draw_scale_bar},
    solid::{PlacedSolid, SolidHit},
    spun_yarn::{Spin, surface},
    tube::{TubeHit, Tubes},
    yarn_colors::point_colors,
};
use crate::geometry::SolidShape;

/// Half the angle that the key light spans, as a tangent.
const KEY_SPREAD: f32 = 0.07;
/// How far things dim the light from all around, in yarn radii.
const AMBIENT_REACH: f32 = 7.0;

/// Light that the ground keeps in the deepest shadow: paper shines through.
const GROUND_SHADE: f32 = 0.3;
/// Samples of a pixel that must find plain background for the rest to be left out.
const PLAIN_SAMPLES: u32 = 2;

/// Makes the picture.
#[must_use]
pub fn render(subject: &Subject, camera: &Camera, settings: &Settings) -> Image {
    let (colors, legend) = point_colors(subject, settings);
    let stage = Stage::new(subject, camera, settings, &colors);
    let (width, height) = (settings.width.max(1), settings.height.max(1));
    let mut image = Image::filled(width, height, settings.background);
    image.pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            *pixel = to_srgb(stage.pixel(x, y, width, height));
        }
    });
    if settings.scale_bar {
        draw_scale_bar(&mut image, camera.height / height as f64);
    }
    if let Some(caption) = &settings.caption {
        draw_caption(&mut image, caption);
    }
    if let Some(legend) = &legend {
        draw_legend(&mut image, legend);
    }
    image
}

/// Everything the rays need, in single precision about the camera's target.
struct Stage<'a> {
    camera: &'a Camera,
    settings: &'a Settings,
    tubes: Tubes,
    /// Seen only: hair is too thin to shade anything.
    hair: Tubes,
    solids: Vec<PlacedSolid>,
    /// The shadow-catching plane: its normal, and its height along it.
    ground: Option<(Vec3, f32)>,
    background: Vec3,
    /// The background as samples bring it.
    plain: Vec3,
    light: Light,
    reach: f32,
}

/// The nearest thing on a ray.
enum Seen {
    Yarn(TubeHit),
    Hair(TubeHit),
    Solid(SolidHit),
    Ground(f32),
    Nothing,
}

impl<'a> Stage<'a> {
    fn new(subject: &Subject, camera: &'a Camera, settings: &'a Settings, colors: &[Vec<Vec3>]) -> Self {
        let (points, radius) = subject.extent_points();
        let ground = settings.ground.and_then(DVec3::try_normalize).and_then(|normal| {
            let low = points
                .iter()
                .filter(|p| p.is_finite())
                .map(|p| (*p - camera.target).dot(normal))
                .fold(f64::INFINITY, f64::min);
            low.is_finite().then_some((normal.as_vec3(), (low - 1.02 * radius) as f32))
        });
        let key = -0.62 * camera.right + 0.62 * camera.up + 0.60 * camera.back;
        let background = before_shoulder(to_linear(settings.background));
        // Hair is seen close up only; it thins out with distance, and far away it is not worth its rays.
        let pixels = radius / camera.height * settings.height as f64;
        let density = settings.hair * ((pixels - 4.0) / 6.0).clamp(0.0, 1.0);
        let hair = if density > 0.0 {
            let (curves, colors) = hairs(subject.curves, colors, density);
            Tubes::new(&curves, &colors, camera.target)
        } else {
            Tubes::default()
        };
        // A plate that the eye looks through neither shows nor shades.
        let eye = camera.target + camera.distance * camera.back;
        let solids = subject.solids.iter().filter(|s| s.shape != SolidShape::Plane || s.height(eye) > 0.0);
        Self {
            camera,
            settings,
            hair,
            tubes: Tubes::new(subject.curves, colors, camera.target),
            solids: solids.map(|s| PlacedSolid::new(s, camera.target)).collect(),
            ground,
            background,
            plain: shoulder(background),
            light: Light { to_key: key.normalize().as_vec3(), up: camera.up.as_vec3() },
            reach: AMBIENT_REACH * (if radius > 0.0 { radius } else { 0.01 * camera.height }) as f32,
        }
    }

    /// Mean light of a pixel.
    fn pixel(&self, x: usize, y: usize, width: usize, height: usize) -> Vec3 {
        let samples = self.settings.samples.max(1);
        let mut sum = Vec3::ZERO;
        let mut all_plain = true;
        for sample in 0..samples {
            let dice = Dice { x: x as u32, y: y as u32, sample };
            // The sample pattern is the same in every pixel; a tent a little wider than the pixel smooths edges.
            let [a, b] = plastic(sample, [0.5, 0.5]);
            let (dx, dy) = (tent(a), tent(b));
            let half = 0.5 * height as f64;
            let px = (x as f64 + 0.5 + f64::from(dx) - 0.5 * width as f64) / half;
            let py = (half - y as f64 - 0.5 - f64::from(dy)) / half;
            let (origin, direction) = self.camera.ray(px, py);
            let ray = Ray { origin: (origin - self.camera.target).as_vec3(), direction: direction.as_vec3() };
            // Cut each sample before the mean: one glint must not outshine the rest of an edge pixel.
            let light = shoulder(self.light_along(ray, dice));
            sum += light;
            all_plain &= light == self.plain;
            // Where the first samples see nothing but the empty, unshaded ground the rest would too.
            if all_plain && sample + 1 >= PLAIN_SAMPLES {
                return self.plain;
            }
        }
        sum / samples as f32
    }

    fn look(&self, ray: Ray) -> Seen {
        let mut limit = f32::INFINITY;
        let mut seen = Seen::Nothing;
        for solid in &self.solids {
            if let Some(hit) = solid.entry(ray).filter(|h| h.distance < limit) {
                limit = hit.distance;
                seen = Seen::Solid(hit);
            }
        }
        if let Some((normal, height)) = self.ground {
            let t = (height - ray.origin.dot(normal)) / ray.direction.dot(normal);
            if ray.direction.dot(normal) < -1e-4 && t > 0.0 && t < limit {
                limit = t;
                seen = Seen::Ground(t);
            }
        }
        if let Some(hit) = self.tubes.closest(ray, limit) {
            limit = hit.distance;
            seen = Seen::Yarn(hit);
        }
        if let Some(hit) = self.hair.closest(ray, limit) {
            seen = Seen::Hair(hit);
        }
        seen
    }

    /// Whether something stands in a ray's way before `limit`.
    fn blocked(&self, ray: Ray, limit: f32) -> bool {
        self.tubes.any(ray, limit) || self.solids.iter().any(|s| s.entry(ray).is_some_and(|h| h.distance < limit))
    }

    fn light_along(&self, ray: Ray, dice: Dice) -> Vec3 {
        match self.look(ray) {
            Seen::Nothing => self.background,
            Seen::Yarn(hit) => self.yarn_light(ray, hit, dice),
            Seen::Hair(hit) => self.hair_light(ray, hit, dice),
            Seen::Solid(hit) => {
                let at = ray.origin + hit.distance * ray.direction;
                let (key, open) = self.arriving(at, hit.normal, dice);
                let light = self.light.surface(hit.color, [hit.normal; 2], -ray.direction, key, open);
                // An endless plane runs out into the background instead of ending at a horizon.
                let far = at.length() / self.camera.height as f32;
                let fade = if hit.endless { ((far - 1.2) / 2.5).clamp(0.0, 1.0) } else { 0.0 };
                light.lerp(self.background, fade * fade * (3.0 - 2.0 * fade))
            }
            Seen::Ground(distance) => {
                let at = ray.origin + distance * ray.direction;
                let normal = self.ground.map_or(Vec3::Z, |(n, _)| n);
                let (key, open) = self.arriving(at, normal, dice);
                let direct = KEY * self.light.to_key.dot(normal).max(0.0);
                let around = 0.5;
                if key == 1.0 && open == 1.0 {
                    return self.background;
                }
                let share = (direct * key + around * open) / (direct + around);
                self.background * (GROUND_SHADE + (1.0 - GROUND_SHADE) * share)
            }
        }
    }

    /// How much of the key light and of the light from all around arrives, from 0 to 1 each.
    fn arriving(&self, at: Vec3, normal: Vec3, dice: Dice) -> (f32, f32) {
        let start = at + 1e-2 / AMBIENT_REACH * self.reach * normal;
        let [a, b] = dice.pair(0, dice.sample);
        let side = self.light.to_key.any_orthonormal_vector();
        let other = self.light.to_key.cross(side);
        let (sin, cos) = (std::f32::consts::TAU * a).sin_cos();
        let spread = KEY_SPREAD * b.sqrt();
        let direction = (self.light.to_key + spread * (cos * side + sin * other)).normalize();
        let faces = normal.dot(self.light.to_key) > -0.3;
        let ray = Ray { origin: start, direction };
        let key = if faces && !self.blocked(ray, f32::INFINITY) { 1.0 } else { 0.0 };
        let count = self.settings.ambient_rays;
        if count == 0 {
            return (key, 1.0);
        }
        let (side, other) = (normal.any_orthonormal_vector(), Vec3::ZERO);
        let other = if other == Vec3::ZERO { normal.cross(side) } else { other };
        let mut open = 0.0;
        for i in 0..count {
            let [a, b] = dice.pair(1, dice.sample * count + i);
            let (sin, cos) = (std::f32::consts::TAU * a).sin_cos();
            let (flat, high) = (b.sqrt(), (1.0 - b).sqrt());
            let direction = flat * (cos * side + sin * other) + high * normal;
            let ray = Ray { origin: start, direction };
            if !self.blocked(ray, self.reach) {
                open += 1.0;
            }
        }
        (key, open / count as f32)
    }

    fn hair_light(&self, ray: Ray, hit: TubeHit, dice: Dice) -> Vec3 {
        let capsule = self.hair.capsules[hit.capsule as usize];
        let at = ray.origin + hit.distance * ray.direction;
        let axis = (capsule.b - capsule.a).normalize_or(Vec3::X);
        // A hair is lit all around: what counts is how squarely it lies to the light.
        let normal = (self.light.to_key - self.light.to_key.dot(axis) * axis).normalize_or(-ray.direction);
        let (key, open) = self.arriving(at, normal, dice);
        let color = self.hair.points[capsule.first as usize].color;
        self.light.surface(color.lerp(Vec3::ONE, 0.06), [normal; 2], -ray.direction, 0.55 * key, 0.85 * open)
    }

    fn yarn_light(&self, ray: Ray, hit: TubeHit, dice: Dice) -> Vec3 {
        let capsule = self.tubes.capsules[hit.capsule as usize];
        let first = capsule.first as usize;
        let (a, b) = (self.tubes.points[first], self.tubes.points[first + 1]);
        let radius = capsule.radius;
        let at = ray.origin + hit.distance * ray.direction;
        let axis = b.position - a.position;
        let s = ((at - a.position).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
        let tangent = a.tangent.lerp(b.tangent, s).normalize_or(a.tangent);
        // A cubic through both ends with their tangents: the yarn's bend shows in the light, not its corners.
        let t = (1.0 - s) * s;
        let bow = t * ((1.0 - s) * (axis.length() * a.tangent - axis) - s * (axis.length() * b.tangent - axis));
        let spoke = at - (a.position + s * axis + bow);
        let smooth = (spoke - spoke.dot(tangent) * tangent).normalize_or(-ray.direction);
        let zero = a.normal.lerp(b.normal, s);
        let zero = (zero - zero.dot(tangent) * tangent).normalize_or(tangent.any_orthonormal_vector());
        let angle = smooth.dot(tangent.cross(zero)).atan2(smooth.dot(zero));
        let arc_length = a.arc_length + f64::from(s) * (b.arc_length - a.arc_length);
        let spin = Spin { plies: self.settings.plies, twist: self.settings.twist, radius: f64::from(radius) };
        // Pixels across a yarn's radius decide what can be seen of its plies.
        let pixels = radius * self.settings.height as f32 / self.camera.height as f32;
        let detail = ((pixels - 0.8) / 3.0).clamp(0.0, 1.0);
        let spun = surface(spin, angle, arc_length, detail);
        let around = tangent.cross(smooth);
        let [outward, sideways, along] = spun.normal;
        let normal = (outward * smooth + sideways * around + along * tangent).normalize_or(smooth);
        let (key, open) = self.arriving(at, smooth, dice);
        let groove = 1.0 - 0.5 * (1.0 - spun.crest) * (1.0 - spun.crest);
        let color = a.color.lerp(b.color, s) * (1.0 + 0.30 * spun.streak);
        let normals = [normal, smooth];
        self.light.surface(color.min(Vec3::splat(0.95)), normals, -ray.direction, key * groove.sqrt(), open * groove)
            * groove
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geometry::{Curve, Solid},
        picture::{Projection, View},
    };

    /// Two straight yarns along x, the second on the key light's far side, and a ball under them.
    fn subject() -> (Vec<Curve>, Vec<Solid>) {
        let yarn = |y: f64, color: [u8; 3]| Curve {
            points: (0..21).map(|i| DVec3::new(f64::from(i) * 1e-3, y, 0.0)).collect(),
            arc_length: (0..21).map(|i| f64::from(i) * 1e-3).collect(),
            pass: vec![0; 21],
            radius: 1e-3,
            color,
        };
        let ball = Solid::new(SolidShape::Sphere { radius: 2e-3 }, DVec3::new(0.01, -0.006, 0.0));
        (vec![yarn(0.0, [200, 30, 30]), yarn(0.004, [30, 30, 200])], vec![ball])
    }

    fn small() -> Settings {
        Settings { width: 120, height: 90, scale_bar: false, ..Settings::default() }
    }

    fn picture(settings: &Settings) -> Image {
        let (curves, solids) = subject();
        let subject = Subject { curves: &curves, scalars: None, solids: &solids };
        let (points, radius) = subject.extent_points();
        let camera = Camera::framing(View::Front, Projection::Orthographic, &points, radius, 4.0 / 3.0, 0.1);
        render(&subject, &camera, settings)
    }

    #[test]
    fn yarns_ball_and_ground_show_their_colours() {
        let image = picture(&small());
        let count = |test: &dyn Fn([u8; 3]) -> bool| image.pixels.iter().filter(|p| test(**p)).count();
        assert!(count(&|p| p[0] / 2 > p[2]) > 300, "red yarn");
        assert!(count(&|p| p[2] / 2 > p[0]) > 300, "blue yarn");
        let background = small().background;
        assert_eq!(image.pixel(0, 0), background);
        let grey = |p: [u8; 3]| p.iter().max().unwrap() - p.iter().min().unwrap() < 20 && p[0] < 225;
        assert!(count(&grey) > 100, "ball or shadow");
    }

    #[test]
    fn things_throw_shadows_on_the_ground_only_if_there_is_one() {
        let background = small().background;
        let plain = |settings: &Settings| picture(settings).pixels.iter().filter(|p| **p == background).count();
        let (with, without) = (plain(&small()), plain(&Settings { ground: None, ..small() }));
        assert!(without > with + 200, "{without} {with}");
    }

    #[test]
    fn a_plate_in_front_of_everything_is_looked_through() {
        let (curves, _) = subject();
        let bare = Subject { curves: &curves, scalars: None, solids: &[] };
        let (points, radius) = bare.extent_points();
        let camera = Camera::framing(View::Front, Projection::Orthographic, &points, radius, 4.0 / 3.0, 0.1);
        let glass = Solid::new(SolidShape::Plane, camera.target + 0.02 * camera.back).pointing(-camera.back);
        let wall = Solid::new(SolidShape::Plane, camera.target - 2.0 * radius * camera.back).pointing(camera.back);
        let seen = |solids: &[Solid]| render(&Subject { solids, ..bare }, &camera, &small());
        assert!(camera.distance > 0.02, "the eye is above the glass: {}", camera.distance);
        assert!(seen(&[glass]) == seen(&[]), "glass");
        assert!(seen(&[wall]) != seen(&[]), "wall");
    }

    #[test]
    fn one_and_four_threads_make_the_same_bits() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| picture(&small()))
        };
        assert!(on(1) == on(4));
    }

    #[test]
    fn an_empty_picture_is_background() {
        let camera = Camera::framing(View::Front, Projection::Orthographic, &[], 0.0, 1.0, 0.1);
        let image = render(&Subject::default(), &camera, &small());
        assert!(image.pixels.iter().all(|p| *p == small().background));
    }
}
