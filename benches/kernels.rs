//! Benchmarks of the solver: its kernels one by one and whole solves of the default scene.
//!
//! `cargo bench --no-default-features` runs Criterion and ends with a report;
//! `cargo bench --no-default-features --bench kernels -- --report` gives the report alone. It holds
//! each kernel against what the machine can do, measured in the same run: see [`Limits`].

#![allow(clippy::print_stdout)]

use criterion::{BenchmarkId, Criterion, Throughput};
use implant_preview::scene::Scene;
use implant_preview::solve::kernels::{Kernel, Kernels};
use implant_preview::solve::{Problem, Progress, Solver};
use std::hint::black_box;
use std::time::{Duration, Instant};
use wide::f32x4;

const SIZES: [usize; 4] = [65, 129, 257, 513];
const TOLERANCES: [f64; 2] = [1e-3, 1e-4];
/// Centred, and off the centre by this much \[mm\].
const PLACES: [(&str, f64); 2] = [("centred", 0.0), ("off-centre", 10.0)];

/// Rounds of a measurement, of which the quickest counts: others use the machine too.
const ROUNDS: usize = 25;
const ROUND: Duration = Duration::from_millis(4);
/// Triads beyond the caches of one core, within the second level and within the first \[bytes\].
const TRIADS: [(&str, f64); 3] = [("memory", 256e6), ("L2", 500e3), ("L1", 24e3)];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let is_report = arguments == ["--report"];
    if !is_report {
        let mut criterion = Criterion::default()
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(1))
            .sample_size(20)
            .configure_from_args();
        bench_kernels(&mut criterion);
        bench_solves(&mut criterion);
        criterion.final_summary();
    }
    if is_report || arguments.is_empty() {
        report();
    }
}

/// The default scene as a sheet with the dome off the centre by `x` mm.
fn problem(nodes_per_side: usize, x: f64, tolerance: f64) -> Problem {
    let mut scene = Scene::sheet();
    scene.implant.center_mm = [x, 0.0];
    scene.solver.nodes_per_side = nodes_per_side;
    scene.solver.tolerance = tolerance;
    scene.problem().expect("the default scene is within its limits")
}

fn solved(nodes_per_side: usize) -> Kernels {
    Kernels::new(&problem(nodes_per_side, 0.0, 1e-4)).expect("the default scene can be solved")
}

fn solve(problem: Problem) -> Solver {
    let mut solver = Solver::new(problem);
    while solver.advance(&mut || false) == Progress::Working {}
    solver
}

fn bench_kernels(criterion: &mut Criterion) {
    for kernel in Kernel::ALL {
        let mut group = criterion.benchmark_group(kernel.name());
        for n in SIZES {
            let mut kernels = solved(n);
            group.throughput(Throughput::Elements(kernels.nodes() as u64));
            group.bench_function(BenchmarkId::from_parameter(n), |bencher| {
                bencher.iter(|| black_box(&mut kernels).run(kernel));
            });
        }
    }
}

fn bench_solves(criterion: &mut Criterion) {
    for (place, x) in PLACES {
        for tolerance in TOLERANCES {
            let mut group = criterion.benchmark_group(format!("solve {place} {tolerance:.0e}"));
            group.sample_size(10);
            for n in SIZES {
                let problem = problem(n, x, tolerance);
                let nodes = solve(problem.clone()).nodes_solved();
                group.throughput(Throughput::Elements(nodes as u64));
                group.bench_function(BenchmarkId::from_parameter(n), |bencher| {
                    bencher.iter(|| solve(black_box(problem.clone())));
                });
            }
        }
    }
}

/// The least time of a call \[ns\].
fn least_ns(mut call: impl FnMut()) -> f64 {
    let start = Instant::now();
    call();
    let once = start.elapsed().max(Duration::from_nanos(20));
    let calls = (ROUND.as_nanos() / once.as_nanos()).clamp(1, 1_000_000) as u32;
    let round = |call: &mut dyn FnMut()| {
        let start = Instant::now();
        for _ in 0..calls {
            call();
        }
        start.elapsed().as_nanos() as f64 / f64::from(calls)
    };
    (0..ROUNDS).map(|_| round(&mut call)).fold(f64::INFINITY, f64::min)
}

/// What a kernel computes and moves, counted in the source.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KernelCost {
    /// Additions (and subtractions), multiplications, divisions and square roots, one each.
    flops_per_node: f64,
    /// The divisions and square roots among them: they have a unit of their own.
    divisions_per_node: f64,
    /// Arrays streamed once in and once out \[bytes\].
    bytes_per_node: f64,
}

/// The cost of a node of the finer grid that does not touch.
///
/// How it is counted: every +, −, ×, ÷ and √ of the source is one, in each of the four lanes, for
/// one group of layers and one-sided contact; comparisons, minima, signs, selections, shuffles,
/// indices, and what is computed once a row are none. There is one regular cell a node; border
/// triangles, whose share falls with the spacing, are left out, and so is a curve's line beyond its
/// data. A coarse node is a quarter of a fine one. Of bytes, each array of f32 counts once if it
/// is read and once if it is written, as if caches kept it between passes of one kernel.
fn table(kernel: Kernel) -> KernelCost {
    // (flops, divisions and roots, arrays of f32)
    let (flops, divisions, arrays) = match kernel {
        // measure_row: edges 16, eight products 40, four times s, I₁, t 8: 88. tension, four
        // times: ē 10, secant 6, inverse 2, P and Q 9: 108. pull_row: edges 16, shears 4, four
        // pulls of 20, sums at the corners 24: 124. Each of four triangles: √ of s, t, ē, one ÷.
        // u in; f in and out.
        Kernel::Force => (88 + 108 + 124, 16, 9.0),
        // cell_block: edges 16, means 12, metric 15, s and I₁ 5, stiffness 51 (t 3, ē 10, secant
        // and slope 9, sums 29), 1/s and 1/t 2, normal 12, across 4, nnᵀ 15, τ₁ and τ₂ 36, two
        // stretches of 42, isotropic 3, doubled 6; block_row 18; inverted 36. √ of s, t, ē; ÷:
        // two of the slope, sec′/ē, β/t, 1/s, 1/t, 1/det, 1/trace. u in; six arrays in and out.
        Kernel::Blocks => (261 + 18 + 36, 11, 15.0),
        // D⁻¹f 15, ω 3, square 5, hardening 9, share 3 and its product 3, rest 1, level 21, towards
        // 5, lift 1, over 2, sum 3. ÷: hardening, share, 1/length; √: share, length. f, D⁻¹, u
        // and lift in; u out.
        Kernel::Step => (71, 5, 16.0),
        // Rest 1, level 21, across 5, lift 1, share 6, projection 6, square 6. ÷: 1/length, share;
        // √: length. u, f and lift in; f and hold out.
        Kernel::Residual => (46, 3, 11.0),
        // Eleven a coarse component.
        Kernel::Restriction => (8, 0, 3.75),
        // Interpolation: 1.75 a component in columns that both grids have, 1 in between: 8.25.
        // Rest 1, level 21, normal part 11 and its removal 6, place 3, back 32, its direction 5, sum 6.
        // ÷: 1/length, normal part, back; √: length, back. Two coarse vectors in, the correction
        // out and in, u in and out, hold and lift in.
        Kernel::Correction => (8 + 85, 5, 15.5),
        // Scaled: 10 a coarse node. A component: 1.25 + 2.5 for the cubics, 7 for what multiplies
        // them; settle: rest 1, level 21, ray 2, upright 10, which is shorter 8, out 3, sum 3. ÷: a
        // quarter, 1/length, ray, upright; √: length, height. A coarse vector in, another out and
        // in, u out, in and out.
        Kernel::Refinement => (2 + 32 + 48, 5, 11.25),
    };
    KernelCost {
        flops_per_node: f64::from(flops),
        divisions_per_node: f64::from(divisions),
        bytes_per_node: 4.0 * arrays,
    }
}

/// What a step adds for a node that touches (flops, divisions and roots, arrays): D⁻¹n 15, share 6, d 6,
/// place 3, back 32 (scaled 6, products 15, c 2, root 4, share 2, product 3), sum 6. Share, back; length.
const HELD_STEP: (f64, f64, f64) = (68.0, 3.0, 0.0);
/// What a residual adds: D⁻¹r 15, its normal part 5, gap 1, sum 1. D⁻¹ in.
const HELD_RESIDUAL: (f64, f64, f64) = (22.0, 0.0, 6.0);

/// The cost of a kernel on a solved grid.
fn cost(kernels: &Kernels, kernel: Kernel) -> KernelCost {
    let mut cost = table(kernel);
    let (flops, divisions, arrays) = match kernel {
        Kernel::Step => HELD_STEP,
        Kernel::Residual => HELD_RESIDUAL,
        _ => return cost,
    };
    let active = kernels.active_fraction();
    cost.flops_per_node += active * flops;
    cost.divisions_per_node += active * divisions;
    cost.bytes_per_node += active * 4.0 * arrays;
    cost
}

/// What one core can do at most in lanes of four, as this program is compiled (no fused
/// multiply-add).
struct Limits {
    /// Multiplications and additions, half of each, in registers \[flop/ns\].
    flops: f64,
    /// Divisions and square roots, half of each, in registers \[flop/ns\].
    divisions: f64,
}

impl Limits {
    fn measure() -> Self {
        const STEPS: u32 = 10_000;
        // Chains that do not wait for one another, no two the same.
        fn chains<const N: usize>() -> [f32x4; N] {
            std::array::from_fn(|k| black_box(f32x4::splat(1.0 + k as f32 / 16.0)))
        }
        let per_ns = |operations: usize, ns: f64| f64::from(STEPS) * operations as f64 / ns;
        let (a, b) = (black_box(f32x4::splat(0.99)), black_box(f32x4::splat(0.01)));
        let multiply_add = least_ns(|| {
            let mut x = chains::<12>();
            for _ in 0..STEPS {
                x = x.map(|x| x * a + b);
            }
            black_box(x);
        });
        let divide_root = least_ns(|| {
            let mut x = chains::<12>();
            for _ in 0..STEPS {
                x = x.map(|x| (a / x).sqrt());
            }
            black_box(x);
        });
        Self { flops: per_ns(12 * 2 * 4, multiply_add), divisions: per_ns(12 * 2 * 4, divide_root) }
    }
}

/// Bytes that a triad, a = b + s·c, moves in a nanosecond, if the three arrays have so many bytes
/// together: the limit of a kernel whose arrays have as many.
fn triad(bytes: f64) -> f64 {
    let length = (bytes / 12.0) as usize;
    let (mut a, b, c) = (vec![0.0_f32; length], vec![1.0_f32; length], vec![2.0_f32; length]);
    let s = black_box(0.5);
    let ns = least_ns(|| {
        let (b, c) = (black_box(&b), black_box(&c));
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            *a = b + s * c;
        }
        black_box(&mut a);
    });
    12.0 * length as f64 / ns
}

fn report() {
    let limits = Limits::measure();
    println!("\nLimits of one core, four f32 at a time, least of {ROUNDS} rounds");
    println!("  multiply and add   {:7.1} GFlop/s", limits.flops);
    println!("  divide and root    {:7.1} GFlop/s", limits.divisions);
    for (name, bytes) in TRIADS {
        println!("  triad in {name:<9} {:7.1} GB/s", triad(bytes));
    }
    println!(
        "\nKernels of the default scene; shares are of the limits above, of the triad that moves"
    );
    println!("as many bytes in all\n");
    println!(
        "| kernel | nodes a side | ns/node | flop/node | GFlop/s | of flops | of ÷ and √ | \
         B/node | GB/s | of triad | nearest limit |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut grids = SIZES.map(|n| (n, solved(n)));
    for kernel in Kernel::ALL {
        for (n, kernels) in &mut grids {
            report_kernel(&limits, kernel, *n, kernels);
        }
    }
    println!("\nCold solves\n");
    println!(
        "| dome | tolerance | nodes a side | ms | nodes solved | work units | ns/node | \
         ns/(node·unit) | of flops |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    // A unit of work is an evaluation of the forces and, as a rule, a step of the smoother.
    let flops: f64 =
        [Kernel::Force, Kernel::Step].map(|k| cost(&grids[1].1, k).flops_per_node).iter().sum();
    for (place, x) in PLACES {
        for tolerance in TOLERANCES {
            for n in SIZES {
                let problem = problem(n, x, tolerance);
                let solver = solve(problem.clone());
                let ns = least_ns(|| drop(black_box(solve(problem.clone()))));
                let (nodes, work) = (solver.nodes_solved() as f64, solver.work_units());
                let per_unit = ns / (nodes * work);
                println!(
                    "| {place} | {tolerance:.0e} | {n} | {:.2} | {nodes} | {work:.1} | {:.0} | \
                     {per_unit:.1} | {:.0} % |",
                    ns / 1e6,
                    ns / nodes,
                    100.0 * flops / per_unit / limits.flops,
                );
            }
        }
    }
}

fn report_kernel(limits: &Limits, kernel: Kernel, n: usize, kernels: &mut Kernels) {
    let nodes = kernels.nodes() as f64;
    let cost = cost(kernels, kernel);
    let ns = least_ns(|| black_box(&mut *kernels).run(kernel)) / nodes;
    let others = cost.flops_per_node - cost.divisions_per_node;
    let (flops, bytes) = (cost.flops_per_node / ns, cost.bytes_per_node / ns);
    let shares = [
        ("flops", others / ns / limits.flops),
        ("÷ and √", cost.divisions_per_node / ns / limits.divisions),
        ("bytes", bytes / triad(cost.bytes_per_node * nodes)),
    ];
    let (nearest, _) =
        shares.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("", f64::NAN));
    let [of_flops, of_divisions, of_triad] = shares.map(|(_, share)| 100.0 * share);
    println!(
        "| {} | {n} | {ns:.2} | {:.0} | {flops:.1} | {of_flops:.0} % | {of_divisions:.0} % | {:.0} | \
         {bytes:.1} | {of_triad:.0} % | {nearest} |",
        kernel.name(),
        cost.flops_per_node,
        cost.bytes_per_node,
    );
}
