//! scratch
use wale::geometry::*;
use wale::model::*;
use wale::pattern::{chart::*, knit};
use wale::picture::*;

fn card() -> FabricCard {
    FabricCard {
        loop_length: 17.0e-3,
        transition_length: 0.0,
        stitch_length: 1.7e-3,
        wale_spacing: 5.0e-3,
        course_spacing: 3.8e-3,
        wrapping_stiffness: 1.0,
        wrapping_angle_course: 0.0,
        wrapping_angle_leg: 0.0,
        bend_angle_foot_head: 0.0,
        bend_angle_leg: 0.0,
        length_stiffness: 1.0,
        spacing_stiffness: 1.0,
        spacing_leg: 1e-3,
        spacing_head_sinker: 1e-3,
        anchor_stiffness: 1.0,
        residual_compression: 0.0,
    }
}

#[test]
fn look() {
    let n: usize = std::env::var("N").map_or(12, |n| n.parse().unwrap());
    let chart = Chart::stockinette().repeat(n, n).unwrap();
    let mut network = knit::fabric(&chart, Working::default(), &card());
    network.yarn_color = vec![[176, 62, 54]; network.yarn_count()];
    let frame = Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() };
    let curves = curves(&network, &frame, &CurveSettings::new(0.62e-3));
    let scalars = coloring::point_scalars(&network, &frame, &curves);
    println!("points {}", curves.iter().map(|c| c.points.len()).sum::<usize>());
    let subject = Subject { curves: &curves, scalars: Some(&scalars), ..Default::default() };
    let (points, radius) = subject.extent_points();
    for (name, view, mode) in
        [("front", "front", "yarn"), ("nice", "three-quarter", "yarn"), ("curvature", "back", "curvature")]
    {
        let view: View = view.parse().unwrap();
        let settings = Settings {
            twist: 130.0,
            color_mode: mode.parse().unwrap(),
            caption: Some("stockinette".into()),
            ground: Some(view.ground_normal()),
            ..Settings::default()
        };
        let camera = Camera::framing(view, view.projection(), &points, radius, 4.0 / 3.0, 0.06);
        let t = std::time::Instant::now();
        let image = render(&subject, &camera, &settings);
        println!("{name} {:?}", t.elapsed());
        write_png(&image, std::fs::File::create(format!("/tmp/pics/{name}.png")).unwrap()).unwrap();
        if std::env::var("ONE").is_ok() {
            break;
        }
    }
}
