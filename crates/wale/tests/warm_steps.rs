//! What a warm step may not do, and what a large fabric must do alike on any number of threads.

use wale::model::LinearSolver;
use wale::scene::Scene;
use wale::simulation::{Simulation, Start};

fn garter(side: u32, settings: &str) -> Simulation {
    let text = format!(
        "schema = 1\n[fabric]\ncenter = [0, 0, 0.1]\n[fabric.chart]\npattern = \"garter\"\ncolumns = {side}\nrows = {side}\n\
         [simulation]\nrelax_first = false\n{settings}\n[[obstacle]]\nsphere = {{ center = [0, 0, 0], radius = 0.02 }}\n"
    );
    let scene = Scene::from_text(&text, "test").unwrap();
    let start = Start::new(&scene.structure, &scene.yarns, &scene.fabric, true);
    Simulation::new(start.network, &scene.yarns, &scene.fabric, scene.plan)
}

#[test]
fn a_warm_step_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (solver, name) in
        [(LinearSolver::Cholesky, "cholesky"), (LinearSolver::ConjugateGradient, "conjugate_gradient")]
    {
        for self_contact in [false, true] {
            let settings =
                format!("largest_step = \"1 ms\"\nself_contact = {self_contact}\nlinear_solver = \"{name}\"");
            let mut simulation = garter(12, &settings);
            assert_eq!(simulation.plan().simulation.linear_solver, solver);
            let counts: Vec<u64> = pool.install(|| {
                (0..40).map(|_| allocation_counter::measure(|| drop(simulation.step().unwrap())).count_total).collect()
            });
            println!("{name}, contact with itself {self_contact}: {counts:?}");
            // The first steps take the memory. The eight lists of contacts double when there are more than ever before.
            let allowed = if self_contact { 16 } else { 0 };
            let warm = if self_contact { 5 } else { 1 };
            assert!(counts[0] > 0 && counts[warm..].iter().sum::<u64>() <= allowed, "{name}: {counts:?}");
        }
    }
}

#[test]
fn a_hundred_thousand_nodes_move_alike_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut simulation = garter(158, "largest_step = \"0.1 ms\"\nnewton_iterations = 2");
            assert!(simulation.network().node_count() > 100_000);
            simulation.step().unwrap();
            simulation.state().clone()
        })
    };
    let (one, two) = (run(1), run(2));
    assert!(one.coordinates == two.coordinates && one.velocities == two.velocities && one.anchors == two.anchors);
}
