//! From yarns and obstacles to pixels: rays, light, shadow.
//!
//! One key light with a soft shadow, light from all around dimmed by what stands near, and a faint light from the eye.
//! All "random" numbers follow from the pixel, so a picture has the same bits on any number of threads.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    Camera, ColorMode, Image, Settings, Subject,
    bvh::Ray,
    color_map::{ColorMap, to_linear, to_srgb},
    hair::hairs,
    scale_bar::{Legend, draw_caption, draw_legend, draw_scale_bar},
    solid::{PlacedSolid, SolidHit},
    spun_yarn::{Spin, surface},
    tube::{TubeHit, Tubes},
};
use crate::geometry::Quantity;

/// Strength of the key light on a surface that faces it.
const KEY: f32 = 1.02;
/// Colour of the key light: a little warm.
const KEY_COLOR: Vec3 = Vec3::new(1.0, 0.965, 0.91);
/// Light from above and from below, where nothing stands near.
const SKY: Vec3 = Vec3::new(0.56, 0.60, 0.67);
const BOUNCE: Vec3 = Vec3::new(0.40, 0.37, 0.34);
/// Light from the eye.
const FILL: f32 = 0.10;
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

/// Values at both ends of the colours for a quantity: all but the most extreme hundredth, about zero if signed.
#[must_use]
pub fn color_range(quantity: Quantity, values: &[Vec<f64>]) -> [f64; 2] {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let last = sorted.len().saturating_sub(1) as f64;
        sorted.get((part * last).round() as usize).copied().unwrap_or(0.0)
    };
    let (low, high) = (at(0.01), at(0.99));
    let smallest = 1e-3 / quantity.legend_unit().1;
    if quantity.is_signed() {
        let reach = low.abs().max(high.abs()).max(smallest);
        [-reach, reach]
    } else {
        [0.0, high.max(smallest)]
    }
}

/// The colour map that suits a quantity.
#[must_use]
pub fn color_map(quantity: Quantity) -> ColorMap {
    if quantity.is_signed() { ColorMap::Diverging } else { ColorMap::Sequential }
}

fn point_colors(subject: &Subject, settings: &Settings) -> (Vec<Vec<Vec3>>, Option<Legend>) {
    let scalars = match (settings.color_mode, subject.scalars) {
        (ColorMode::By(quantity), Some(scalars)) => Some((quantity, scalars.of(quantity))),
        _ => None,
    };
    let Some((quantity, values)) = scalars else {
        let plain = |c: &crate::geometry::Curve| vec![to_linear(c.color); c.points.len()];
        return (subject.curves.iter().map(plain).collect(), None);
    };
    let range = settings.color_range.unwrap_or_else(|| color_range(quantity, values));
    let map = color_map(quantity);
    let colors = subject
        .curves
        .iter()
        .enumerate()
        .map(|(c, curve)| {
            (0..curve.points.len())
                .map(|i| {
                    let value = values.get(c).and_then(|v| v.get(i)).copied().unwrap_or(f64::NAN);
                    map.light((value - range[0]) / (range[1] - range[0]))
                })
                .collect()
        })
        .collect();
    let (unit, scale) = quantity.legend_unit();
    let legend = Legend { title: format!("{} [{unit}]", quantity.name()), range: range.map(|v| v * scale), map };
    (colors, Some(legend))
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
    to_key: Vec3,
    up: Vec3,
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
        // The light that the shoulder bends to the colour that was asked for.
        let background = to_linear(settings.background)
            .map(|y| if y <= 0.8 { y } else { 0.8 - 0.2 * (1.0 - (y.min(0.9999) - 0.8) / 0.2).ln() });
        // Hair finer than a fortieth of a pixel is not worth its rays.
        let pixels = radius / camera.height * settings.height as f64;
        let hair = if settings.hair > 0.0 && pixels > 2.0 {
            let (curves, colors) = hairs(subject.curves, colors, settings.hair);
            Tubes::new(&curves, &colors, camera.target)
        } else {
            Tubes::default()
        };
        Self {
            camera,
            settings,
            hair,
            tubes: Tubes::new(subject.curves, colors, camera.target),
            solids: subject.solids.iter().map(|s| PlacedSolid::new(s, camera.target)).collect(),
            ground,
            background,
            plain: shoulder(background),
            to_key: key.normalize().as_vec3(),
            up: camera.up.as_vec3(),
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
                let light = self.lit(hit.color, hit.normal, -ray.direction, key, open);
                // An endless plane runs out into the background instead of ending at a horizon.
                let far = at.length() / self.camera.height as f32;
                let fade = if hit.endless { ((far - 1.2) / 2.5).clamp(0.0, 1.0) } else { 0.0 };
                light.lerp(self.background, fade * fade * (3.0 - 2.0 * fade))
            }
            Seen::Ground(distance) => {
                let at = ray.origin + distance * ray.direction;
                let normal = self.ground.map_or(Vec3::Z, |(n, _)| n);
                let (key, open) = self.arriving(at, normal, dice);
                let direct = KEY * self.to_key.dot(normal).max(0.0);
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
        let side = self.to_key.any_orthonormal_vector();
        let other = self.to_key.cross(side);
        let (sin, cos) = (std::f32::consts::TAU * a).sin_cos();
        let spread = KEY_SPREAD * b.sqrt();
        let direction = (self.to_key + spread * (cos * side + sin * other)).normalize();
        let faces = normal.dot(self.to_key) > -0.3;
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

    /// Light that a rough, slightly hairy surface sends to the eye.
    fn lit(&self, color: Vec3, normal: Vec3, to_eye: Vec3, key: f32, open: f32) -> Vec3 {
        let wrap = 0.18;
        let facing = ((normal.dot(self.to_key) + wrap) / (1.0 + wrap)).max(0.0);
        let above = 0.5 + 0.5 * normal.dot(self.up);
        // Light that is stopped nearby comes back in the stopper's colour, which is most often this one.
        let around = Vec3::splat(open) / (Vec3::ONE - color.min(Vec3::splat(0.9)) * (1.0 - open));
        let ambient = BOUNCE.lerp(SKY, above) * around;
        let eye = normal.dot(to_eye).max(0.0);
        let rim = (1.0 - eye).powi(3) * (0.25 * ambient + 0.22 * key * facing);
        let hair = color.lerp(Vec3::ONE, 0.35);
        color * (KEY * KEY_COLOR * facing * key + ambient + FILL * eye) + hair * rim
    }

    fn hair_light(&self, ray: Ray, hit: TubeHit, dice: Dice) -> Vec3 {
        let capsule = self.hair.capsules[hit.capsule as usize];
        let at = ray.origin + hit.distance * ray.direction;
        let axis = (capsule.b - capsule.a).normalize_or(Vec3::X);
        // A hair is lit all around: what counts is how squarely it lies to the light.
        let normal = (self.to_key - self.to_key.dot(axis) * axis).normalize_or(-ray.direction);
        let (key, open) = self.arriving(at, normal, dice);
        let color = self.hair.points[capsule.first as usize].color;
        self.lit(color.lerp(Vec3::ONE, 0.06), normal, -ray.direction, 0.55 * key, 0.85 * open)
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
        self.lit(color.min(Vec3::splat(0.95)), normal, -ray.direction, key * groove.sqrt(), open * groove) * groove
    }
}

/// Numbers from 0 to 1 of one sample of one pixel.
#[derive(Clone, Copy)]
struct Dice {
    x: u32,
    y: u32,
    sample: u32,
}

impl Dice {
    /// Pair `n` of the given purpose: well spread over the pairs of a pixel, and so unlike between neighbouring pixels
    /// that what is left of the grain is too fine to see.
    fn pair(self, purpose: u32, n: u32) -> [f32; 2] {
        let (x, y) = ((self.x + 61 * purpose) as f32, (self.y + 83 * purpose) as f32);
        // Interleaved gradient noise [Jimenez 2014], and a lattice by the plastic number.
        let first = (52.982_918 * (0.067_110_56 * x + 0.005_837_15 * y).fract()).fract();
        let second = (0.754_877_7 * x).fract() + (0.569_840_3 * y).fract();
        plastic(n, [first, second.fract()])
    }
}

/// Point `n` of the sequence with the steps of the plastic number \[Roberts 2018\]: even for any count.
fn plastic(n: u32, start: [f32; 2]) -> [f32; 2] {
    let n = n as f32;
    [(start[0] + 0.754_877_7 * n).fract(), (start[1] + 0.569_840_3 * n).fract()]
}

/// From 0..1 to a tent over −0.8..0.8.
fn tent(u: f32) -> f32 {
    let v = if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() };
    0.8 * v
}

/// Leaves light below 0.8 as it is and bends what is above towards 1.
fn shoulder(light: Vec3) -> Vec3 {
    let one = |x: f32| {
        if x <= 0.8 { x } else { 0.8 + 0.2 * (1.0 - (-(x - 0.8) / 0.2).exp()) }
    };
    Vec3::new(one(light.x), one(light.y), one(light.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geometry::{Curve, PointScalars, Solid, SolidShape},
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
    fn one_and_four_threads_make_the_same_bits() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| picture(&small()))
        };
        assert!(on(1) == on(4));
    }

    #[test]
    fn colours_follow_the_numbers() {
        let (curves, _) = subject();
        let rising = |c: &Curve| c.points.iter().map(|p| p.x * 1e3).collect::<Vec<f64>>();
        let scalars = PointScalars { curvature: curves.iter().map(rising).collect(), ..PointScalars::default() };
        let subject = Subject { curves: &curves, scalars: Some(&scalars), solids: &[] };
        let settings = Settings { color_mode: ColorMode::By(Quantity::Curvature), ..small() };
        let (colors, legend) = point_colors(&subject, &settings);
        let brightness = |v: Vec3| v.x + v.y + v.z;
        assert!(brightness(colors[0][20]) > 5.0 * brightness(colors[0][0]));
        let legend = legend.unwrap();
        assert_eq!(legend.title, "curvature [1/mm]");
        assert!((legend.range[1] - 0.02).abs() < 1e-3, "{legend:?}");
        // Without numbers the yarn keeps its own colour.
        let (colors, legend) = point_colors(&Subject { scalars: None, ..subject }, &settings);
        assert!(legend.is_none() && colors[0][0].x > colors[0][0].z);
    }

    #[test]
    fn ranges_are_even_about_zero_where_sign_matters() {
        let values = vec![vec![-0.02, 0.0, 0.05, f64::NAN]];
        assert_eq!(color_range(Quantity::Stretch, &values), [-0.05, 0.05]);
        assert_eq!(color_range(Quantity::Curvature, &[vec![200.0, 3.0]]), [0.0, 200.0]);
        assert!(color_range(Quantity::Sliding, &[])[1] > 0.0);
    }

    #[test]
    fn an_empty_picture_is_background() {
        let camera = Camera::framing(View::Front, Projection::Orthographic, &[], 0.0, 1.0, 0.1);
        let image = render(&Subject::default(), &camera, &small());
        assert!(image.pixels.iter().all(|p| *p == small().background));
    }
}
