//! A bounding volume hierarchy: the few primitives a ray may hit, found among many.
//!
//! A binary tree is split by the surface area heuristic in bins, then folded to four children a node, so that one
//! visit tests four boxes at once. The tree depends on the boxes alone: not on threads, not on the order of work.

use glam::{Vec3, Vec4};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
    fn with(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }
    fn centre(self) -> Vec3 {
        0.5 * (self.min + self.max)
    }
    /// Half the surface area; zero for the empty box.
    fn half_area(self) -> f32 {
        let d = (self.max - self.min).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

/// A ray with a unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub distance: f32,
    /// Index of the primitive.
    pub primitive: u32,
}

const BINS: usize = 16;
/// Testing four boxes at once is cheaper than testing one yarn, so leaves are small.
const LEAF_SIZE: usize = 1;
/// Below this many primitives a subtree is built on the thread that found it.
const PARALLEL_SIZE: usize = 4096;
const LEAF_BIT: u32 = 1 << 31;
const NO_CHILD: u32 = u32::MAX;

/// Four boxes side by side; a child is a node index, or a leaf (count − 1 in bits 29–30, first primitive below).
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [Vec4; 3],
    max: [Vec4; 3],
    child: [u32; 4],
}

/// The tree over a list of boxes. It names primitives by their place in leaf order, so that a leaf's lie side by side.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
}

enum Branch {
    Leaf { first: usize, count: usize },
    Inner(Box<[(Bounds, Branch); 2]>),
}

impl Bvh {
    /// Builds the tree over at most 2²⁹ boxes, and tells the order in which it wants the primitives: the k-th of its
    /// primitives is the box `order[k]`.
    #[must_use]
    pub fn new(boxes: &[Bounds]) -> (Self, Vec<u32>) {
        let mut order: Vec<u32> = (0..u32::try_from(boxes.len()).unwrap_or(0)).collect();
        if order.is_empty() {
            return (Self::default(), order);
        }
        let whole = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(*b));
        let root = split(boxes, &mut order, 0);
        let mut tree = Self { nodes: Vec::with_capacity(boxes.len() / 4 + 1) };
        // The root is always a node, so that a tree of one leaf needs no special walk.
        match root {
            Branch::Leaf { .. } => tree.fold(vec![(whole, root)]),
            Branch::Inner(children) => tree.fold(Vec::from(*children)),
        };
        (tree, order)
    }

    /// Writes the node with the given children and returns its index.
    fn fold(&mut self, mut children: Vec<(Bounds, Branch)>) -> u32 {
        while children.len() < 4 {
            let widest = (0..children.len()).filter(|&i| matches!(children[i].1, Branch::Inner(_))).max_by(|&i, &j| {
                let (a, b) = (children[i].0.half_area(), children[j].0.half_area());
                a.total_cmp(&b).then(j.cmp(&i))
            });
            let Some(i) = widest else { break };
            if let (_, Branch::Inner(pair)) = children.remove(i) {
                children.extend(Vec::from(*pair));
            }
        }
        let index = self.nodes.len();
        self.nodes.push(Node { min: [Vec4::INFINITY; 3], max: [Vec4::NEG_INFINITY; 3], child: [NO_CHILD; 4] });
        for (slot, (bounds, branch)) in children.into_iter().enumerate() {
            let child = match branch {
                Branch::Leaf { first, count } => LEAF_BIT | ((count - 1) << 29) as u32 | first as u32,
                Branch::Inner(pair) => self.fold(Vec::from(*pair)),
            };
            let node = &mut self.nodes[index];
            for axis in 0..3 {
                node.min[axis][slot] = bounds.min[axis];
                node.max[axis][slot] = bounds.max[axis];
            }
            node.child[slot] = child;
        }
        index as u32
    }

    /// The nearest hit nearer than `limit`. `test` returns the distance at which a primitive is met nearer than the
    /// limit it is given.
    pub fn closest(&self, ray: Ray, limit: f32, mut test: impl FnMut(u32, f32) -> Option<f32>) -> Option<Hit> {
        let mut best = None;
        let mut limit = limit;
        self.walk(ray, limit, |primitive| {
            if let Some(distance) = test(primitive, limit) {
                limit = distance;
                best = Some(Hit { distance, primitive });
            }
            (limit, false)
        });
        best
    }

    /// Whether anything is met nearer than `limit`.
    pub fn any(&self, ray: Ray, limit: f32, mut test: impl FnMut(u32, f32) -> Option<f32>) -> bool {
        let mut found = false;
        self.walk(ray, limit, |primitive| {
            found |= test(primitive, limit).is_some();
            (limit, found)
        });
        found
    }

    /// Visits primitives near to far by box; `visit` returns the limit from now on, and whether to stop.
    fn walk(&self, ray: Ray, mut limit: f32, mut visit: impl FnMut(u32) -> (f32, bool)) {
        if self.nodes.is_empty() {
            return;
        }
        let safe = |d: f32| {
            if d.abs() < 1e-12 { 1e-12_f32.copysign(d) } else { d }
        };
        let d = ray.direction;
        let inverse = [safe(d.x).recip(), safe(d.y).recip(), safe(d.z).recip()];
        let origin = [ray.origin.x, ray.origin.y, ray.origin.z];
        let mut stack = [(0u32, 0f32); 96];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (code, near) = stack[depth];
            if near > limit {
                continue;
            }
            if code & LEAF_BIT != 0 {
                let first = code & !(LEAF_BIT | (3 << 29));
                let count = ((code >> 29) & 3) + 1;
                for primitive in first..first + count {
                    let (new_limit, stop) = visit(primitive);
                    if stop {
                        return;
                    }
                    limit = new_limit;
                }
                continue;
            }
            let node = &self.nodes[code as usize];
            let (mut enter, mut leave) = (Vec4::ZERO, Vec4::splat(limit));
            for axis in 0..3 {
                let o = Vec4::splat(origin[axis]);
                let t0 = (node.min[axis] - o) * inverse[axis];
                let t1 = (node.max[axis] - o) * inverse[axis];
                enter = enter.max(t0.min(t1));
                leave = leave.min(t0.max(t1));
            }
            let hit = enter.cmple(leave * (1.0 + 4.0 * f32::EPSILON)).bitmask();
            let nears = enter.to_array();
            let start = depth;
            for slot in 0..4 {
                if hit & (1 << slot) != 0 && node.child[slot] != NO_CHILD && depth < stack.len() {
                    // Insertion keeps the nearest child on top of the stack.
                    let near = nears[slot];
                    let mut i = depth;
                    while i > start && stack[i - 1].1 < near {
                        stack[i] = stack[i - 1];
                        i -= 1;
                    }
                    stack[i] = (node.child[slot], near);
                    depth += 1;
                }
            }
        }
    }
}

/// Splits `order` (whose first entry is entry `first` of the whole list) into a branch.
fn split(boxes: &[Bounds], order: &mut [u32], first: usize) -> Branch {
    let count = order.len();
    if count <= LEAF_SIZE {
        return Branch::Leaf { first, count };
    }
    let centres = order.iter().fold(Bounds::EMPTY, |b, &i| b.with(boxes[i as usize].centre()));
    let middle = match best_plane(boxes, order, centres) {
        Some((axis, plane)) => partition(order, |i| bin(boxes[i as usize].centre()[axis], centres, axis) < plane),
        None => count / 2,
    };
    let (left, right) = order.split_at_mut(middle);
    let bounds = |part: &[u32]| part.iter().fold(Bounds::EMPTY, |b, &i| b.union(boxes[i as usize]));
    let (left_bounds, right_bounds) = (bounds(left), bounds(right));
    let (a, b) = if count > PARALLEL_SIZE {
        rayon::join(|| split(boxes, left, first), || split(boxes, right, first + middle))
    } else {
        (split(boxes, left, first), split(boxes, right, first + middle))
    };
    Branch::Inner(Box::new([(left_bounds, a), (right_bounds, b)]))
}

fn bin(centre: f32, centres: Bounds, axis: usize) -> usize {
    let extent = centres.max[axis] - centres.min[axis];
    let s = (centre - centres.min[axis]) / extent * BINS as f32;
    (s as usize).min(BINS - 1)
}

/// Axis and first bin of the right side with the least expected cost; `None` if all centres coincide.
fn best_plane(boxes: &[Bounds], order: &[u32], centres: Bounds) -> Option<(usize, usize)> {
    let mut best = (f32::INFINITY, None);
    for axis in 0..3 {
        if centres.max[axis] - centres.min[axis] <= f32::MIN_POSITIVE {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0usize); BINS];
        for &i in order {
            let b = boxes[i as usize];
            let slot = &mut bins[bin(b.centre()[axis], centres, axis)];
            *slot = (slot.0.union(b), slot.1 + 1);
        }
        let mut right_cost = [0f32; BINS];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for i in (1..BINS).rev() {
            bounds = bounds.union(bins[i].0);
            count += bins[i].1;
            right_cost[i] = if count == 0 { f32::INFINITY } else { bounds.half_area() * count as f32 };
        }
        (bounds, count) = (Bounds::EMPTY, 0);
        for i in 1..BINS {
            bounds = bounds.union(bins[i - 1].0);
            count += bins[i - 1].1;
            if count == 0 {
                continue;
            }
            let cost = bounds.half_area() * count as f32 + right_cost[i];
            if cost < best.0 {
                best = (cost, Some((axis, i)));
            }
        }
    }
    best.1
}

/// Moves the entries that `goes_left` accepts to the front and returns their number.
fn partition(order: &mut [u32], goes_left: impl Fn(u32) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..order.len() {
        if goes_left(order[i]) {
            order.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(state: &mut u64) -> f32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Entry distance into a box, the primitive of these tests.
    fn enter(b: &Bounds, ray: Ray, limit: f32) -> Option<f32> {
        let (t0, t1) = ((b.min - ray.origin) / ray.direction, (b.max - ray.origin) / ray.direction);
        let near = t0.min(t1).max_element().max(0.0);
        let far = t0.max(t1).min_element();
        (near <= far && near < limit).then_some(near)
    }

    #[test]
    fn finds_what_a_search_of_all_boxes_finds() {
        let mut seed = 7;
        for count in [1usize, 3, 5, 64, 6000] {
            let boxes: Vec<Bounds> = (0..count)
                .map(|_| {
                    let p = Vec3::from_array([0; 3].map(|_: i32| random(&mut seed)));
                    let e = 0.05 * Vec3::from_array([0; 3].map(|_: i32| random(&mut seed)));
                    Bounds { min: p, max: p + e }
                })
                .collect();
            let (tree, order) = Bvh::new(&boxes);
            let boxes: Vec<Bounds> = order.iter().map(|i| boxes[*i as usize]).collect();
            let mut hits = 0;
            for _ in 0..300 {
                let origin = Vec3::from_array([0; 3].map(|_: i32| 3.0 * random(&mut seed) - 1.0));
                let target = Vec3::from_array([0; 3].map(|_: i32| random(&mut seed)));
                let ray = Ray { origin, direction: (target - origin).normalize() };
                let brute = boxes.iter().filter_map(|b| enter(b, ray, f32::INFINITY)).min_by(f32::total_cmp);
                let found = tree.closest(ray, f32::INFINITY, |i, limit| enter(&boxes[i as usize], ray, limit));
                assert_eq!(found.map(|h| h.distance), brute);
                let any = tree.any(ray, f32::INFINITY, |i, limit| enter(&boxes[i as usize], ray, limit));
                assert_eq!(any, brute.is_some());
                hits += usize::from(any);
            }
            assert!(count < 64 || hits > 10, "{hits} rays hit {count} boxes");
        }
    }

    #[test]
    fn boxes_that_coincide_and_no_boxes_are_fine() {
        let b = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
        let (tree, _) = Bvh::new(&vec![b; 1000]);
        let ray = Ray { origin: Vec3::new(0.5, 0.5, -2.0), direction: Vec3::Z };
        let mut visited = 0;
        tree.any(ray, 10.0, |_, _| {
            visited += 1;
            None
        });
        assert_eq!(visited, 1000);
        assert!(!Bvh::new(&[]).0.any(ray, 10.0, |_, _| Some(0.0)));
    }
}
