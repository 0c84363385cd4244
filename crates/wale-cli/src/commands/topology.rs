//! `wale check --topology`: whether yarns go where the chart or the draft sends them, before and after a run.

use std::path::Path;

use serde_json::{Value, json};
use wale::geometry::{CrossingOrder, CurveSettings, Passages, curves, fronts};
use wale::measure::Census;
use wale::model::{Frame, Network, NodeId, PassId, YarnId};

use crate::arguments::{Check, FrameChoice};
use crate::exit::{Code, Failure};
use crate::opened::{OpenedRun, OpenedScene, no_yarn};
use crate::output::{self, grouped};
use crate::say;

/// Places of each kind of fault that are said.
const SHOWN: usize = 5;

/// What was found of one frame.
struct Found {
    yarns: usize,
    passes: usize,
    /// Yarns whose passes do not follow each other along them.
    broken: Vec<usize>,
    order: CrossingOrder,
    dropped: Vec<[u32; 2]>,
}

/// Checks a scene, or a run from its first frame to its last.
pub fn topology(arguments: &Check) -> Result<(), Failure> {
    if arguments.scene.is_dir() {
        no_yarn(&arguments.scene, arguments.yarn)?;
        return run(&arguments.scene, arguments.json);
    }
    scene(arguments)
}

fn scene(arguments: &Check) -> Result<(), Failure> {
    let opened = OpenedScene::read_with_yarn(&arguments.scene, arguments.yarn)?;
    opened.check_memory(arguments.limits.max_memory)?;
    let network = opened.plain_network();
    let frame = Frame { time: 0.0, positions: network.position.clone(), sliding: network.arc_length.clone() };
    let census = Census::of(&network, &opened.scene.yarns, &opened.scene.fabric);
    let settings = CurveSettings::of(&opened.scene.yarns, &opened.scene.fabric);
    let found = look(&network, &frame, &settings, census.unsupported_loops);
    report(&arguments.scene, arguments.json, &network, &[("layout", found)], None)
}

fn run(folder: &Path, as_json: bool) -> Result<(), Failure> {
    let opened = OpenedRun::open(folder, FrameChoice::All)?;
    let (network, settings) = (&opened.network, opened.curve_settings());
    let census = Census::of(network, &opened.scene.yarns, &opened.scene.fabric);
    let mut passages = Passages::of(network);
    let mut before: Option<Frame> = None;
    let mut looked = Vec::new();
    for index in opened.frames.clone() {
        let frame = opened.frame(index)?;
        if let Some(before) = &before {
            passages.follow(&opened.curves(before), &opened.curves(&frame));
        }
        let last = index + 1 == opened.frames.end;
        if before.is_none() || last {
            let of = |frame: &Frame| look(network, frame, &settings, census.unsupported_loops.clone());
            looked.push((if last { "last frame" } else { "first frame" }, of(&frame)));
        }
        before = Some(frame);
    }
    report(folder, as_json, network, &looked, Some(&passages))
}

fn look(network: &Network, frame: &Frame, settings: &CurveSettings, dropped: Vec<[u32; 2]>) -> Found {
    let mut network = network.clone();
    network.pulled_out = network.pulled_out_at(&frame.sliding);
    let rising = |yarn: &usize| {
        let passes = network.yarn_passes(YarnId::new(*yarn));
        let live: Vec<f64> = passes.filter(|&p| !network.is_out(PassId::new(p))).map(|p| frame.sliding[p]).collect();
        live.windows(2).all(|pair| pair[1] > pair[0])
    };
    let drawn = curves(&network, frame, settings);
    Found {
        yarns: network.yarn_count(),
        passes: network.pass_count() - network.pulled_out.iter().filter(|out| **out).count(),
        broken: (0..network.yarn_count()).filter(|yarn| !rising(yarn)).collect(),
        order: CrossingOrder::of(&network, &drawn, &fronts(&network, frame)),
        dropped,
    }
}

fn report(
    path: &Path,
    as_json: bool,
    network: &Network,
    looked: &[(&str, Found)],
    passages: Option<&Passages>,
) -> Result<(), Failure> {
    let passed: Vec<[u32; 2]> = passages.map(|passages| passages.pairs().collect()).unwrap_or_default();
    let at = |node: NodeId| {
        let place = network.chart_place[node.index()];
        format!("row {:.0}, column {:.0}", place[1] + 1.0, place[0] + 1.0)
    };
    let of = |pass: u32| network.pass_node[pass as usize];
    if as_json {
        let frames: Vec<Value> = looked.iter().map(|(name, found)| found.json(name)).collect();
        output::json(&json!({
            "path": path,
            "frames": frames,
            "crossings_on_the_way": passages.map(|passages| passages.crossings),
            "yarns_passed_through": passed,
        }))?;
    } else {
        say!("{}", path.display())?;
        for (name, found) in looked {
            found.say(name)?;
            for &node in found.order.wrong.iter().take(SHOWN) {
                say!("             at {}", at(node))?;
            }
        }
        if let Some(passages) = passages {
            say!("  between  {} crossings of drawn yarns, {} of them not undone", passages.crossings, passed.len())?;
            for &[a, b] in passed.iter().take(SHOWN) {
                say!("             at {} and {}", at(of(a)), at(of(b)))?;
            }
        }
    }
    let sound = looked.iter().all(|(_, found)| found.broken.is_empty() && found.order.wrong.is_empty());
    if sound && passed.is_empty() {
        return Ok(());
    }
    Err(Failure::new(Code::BadInput, format_args!("{}: yarns do not go as the chart says", path.display())))
}

impl Found {
    fn json(&self, name: &str) -> Value {
        json!({
            "frame": name,
            "yarns": self.yarns,
            "passes": self.passes,
            "broken_yarns": self.broken,
            "contacts_in_order": self.order.right,
            "contacts_out_of_order": self.order.wrong.len(),
            "contacts_apart": self.order.apart,
            "unsupported_loops": self.dropped,
        })
    }

    fn say(&self, name: &str) -> Result<(), Failure> {
        say!("  {name}")?;
        say!(
            "    yarns    {} through {} contacts, {}",
            self.yarns,
            grouped(self.passes as u64),
            if self.broken.is_empty() {
                "each in order along itself".to_owned()
            } else {
                format!("{} of them broken", self.broken.len())
            }
        )?;
        say!(
            "    crossing {} as the chart says, {} the other way, {} beside each other",
            grouped(self.order.right as u64),
            self.order.wrong.len(),
            self.order.apart
        )?;
        say!("    holds    {} loops that nothing holds", self.dropped.len())
    }
}
