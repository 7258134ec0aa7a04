//! What a render leaves: pictures, report, and a summary for people.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use ::cycles::flow::Recording;
use indicatif::{ProgressBar, ProgressStyle};
use tracer::unit::Termination;

use super::folder::{self, Written};
use super::options::{Pixels, Reference};
use super::{Job, Origin, RenderError, cycles};
use crate::collector::{Collection, CoreRecord, End};
use crate::firmware::SoftFloat;
use crate::firmware::board::INSTRUCTIONS_PER_TICK;
use crate::image::openexr;
use crate::image::picture::Estimate;
use crate::oracle::compare::{Comparison, compare};
use crate::oracle::difference;
use crate::oracle::lockstep::{self, Paired};
use crate::oracle::reference::{self, Rendered, cache, effort};
use crate::platform::console::note;
use crate::platform::file::WriteError;
use crate::render::report::{self, Cost, LockstepError, Report};

/// Seed of the reference: any, as long as it stays the same.
const REFERENCE_SEED: u64 = 0x5eed;

/// What was collected, and all that a report says of it.
pub(super) struct Results<'a> {
    pub(super) job: &'a Job,
    pub(super) collection: &'a Collection,
    pub(super) origin: Origin,
    pub(super) wall: Duration,
    pub(super) memory: Option<u64>,
    pub(super) recordings: &'a [Recording],
}

/// How wrong the picture is.
pub(super) struct Verdict {
    /// The picture with its noise.
    image: Estimate,
    /// With what it was compared, and how that went.
    against: (Estimate, Comparison),
    lockstep: Option<LockstepError>,
}

impl Results<'_> {
    /// The collected picture, and the variance of its pixels where it is known.
    fn image(&self, variance: Option<Vec<[f64; 3]>>) -> Estimate {
        Estimate {
            picture: self.collection.film.picture(),
            variance,
            spp: Some(self.job.options.spp),
        }
    }

    /// Compares with the reference and with the lockstep oracle, if anything is to be compared.
    pub(super) fn judge(&self) -> Result<Option<Verdict>, RenderError> {
        if self.job.options.reference == Some(Reference::None) {
            return Ok(None);
        }
        let oracle = self.oracle();
        let own = self.image(oracle.as_ref().and_then(|oracle| oracle.picture.variance.clone()));
        let (image, reference) = match &self.job.reference {
            Some(given) => (own, given.clone()),
            None => {
                let rendered = self.computed_reference(&own);
                (
                    rendered.pooled_noise(own, self.job.options.integrator()),
                    rendered.estimate,
                )
            }
        };
        let lockstep = oracle.map(|oracle| LockstepError::between(&image.picture, &oracle));
        let comparison = compare(&image, &reference)?;
        Ok(Some(Verdict {
            image,
            against: (reference, comparison),
            lockstep: lockstep.transpose()?,
        }))
    }

    /// The reference for `image`: with as many samples as were asked for, else as many as it takes.
    fn computed_reference(&self, image: &Estimate) -> Rendered {
        let options = &self.job.options;
        let termination = match options.termination.0 {
            Termination::Roulette => reference::Termination::Roulette,
            Termination::Depth(depth) => reference::Termination::Depth(depth),
        };
        match options.reference_spp {
            Some(spp) => self.rendered_reference(&reference::Job {
                width: options.size.width,
                height: options.size.height,
                spp,
                termination,
                seed: REFERENCE_SEED,
            }),
            None => {
                let render = |job: &reference::Job| self.rendered_reference(job);
                effort::reference_for(image, options.integrator(), termination, REFERENCE_SEED, render)
            }
        }
    }

    fn rendered_reference(&self, job: &reference::Job) -> Rendered {
        note(format!("double precision at {} samples per pixel", job.spp));
        let bar = bar("reference", job.samples());
        let done = |samples| bar.set_position(samples);
        let folder = cache::folder(self.job.options.reference_cache.as_deref());
        let (rendered, origin) = cache::reference(folder.as_deref(), &self.job.scene, job, done);
        bar.finish_and_clear();
        if let Some(warning) = origin.warning() {
            note(warning);
        }
        rendered
    }

    /// The same samples once more, and in exact arithmetic. Free-running orders take the same units; not so the stochastic one,
    /// whose samples are others each time.
    fn oracle(&self) -> Option<Paired> {
        let options = &self.job.options;
        if options.pixels == Pixels::Stochastic {
            return None;
        }
        let (compiled, plan) = (&self.job.compiled, &self.job.plan);
        let bar = bar("lockstep", self.collection.film.samples());
        let done = |samples| bar.inc(samples);
        let rendered = match self.origin.choice {
            Some(choice) => lockstep::render_choice(choice, compiled, plan, done),
            None => lockstep::render_as(options.profile, options.sampler(), compiled, plan, done),
        };
        bar.finish_and_clear();
        Some(rendered)
    }

    /// Writes pictures and report into the folder for them. Elsewhere, they are kept but it is an error.
    pub(super) fn write_here(&self, verdict: Option<&Verdict>) -> Result<Report, RenderError> {
        match self.write(verdict)? {
            Written::Here(report) => Ok(report),
            Written::Elsewhere { why, folder } => Err(RenderError::Elsewhere { why, folder }),
        }
    }

    fn write(&self, verdict: Option<&Verdict>) -> Result<Written<Report>, WriteError> {
        self.job
            .out
            .replace(&folder::places(), |folder| self.write_into(folder, verdict))
    }

    /// Writes pictures and report.
    fn write_into(&self, out: &Path, verdict: Option<&Verdict>) -> Result<Report, WriteError> {
        let against = verdict.map(|verdict| &verdict.against);
        let image = verdict.map_or_else(|| self.image(None), |verdict| verdict.image.clone());
        openexr::write(&out.join("image.exr"), &image)?;
        image.picture.write_png(&out.join("image.png"))?;
        let report = self.report(&image, verdict);
        report.write(&out.join("report.json"))?;
        if let Some((reference, comparison)) = against {
            openexr::write(&out.join("reference.exr"), reference)?;
            let title = format!("{} {}", self.job.scene.name, self.job.options.profile);
            let path = out.join("difference.png");
            difference::write(&path, &title, &image.picture, &reference.picture, comparison)?;
        }
        Ok(report)
    }

    /// Writes what there is of a picture, and says so.
    pub(super) fn keep_partial(&self) -> Result<String, RenderError> {
        let log = self.origin.log.as_ref();
        let log = log.map(|log| format!("; the log is {}", log.display()));
        let log = log.unwrap_or_default();
        if self.collection.film.samples() == 0 {
            return Ok(format!("not a single unit came, so there is no picture{log}"));
        }
        let (folder, why) = match self.write(None)? {
            Written::Here(_) => (self.job.out().to_owned(), String::new()),
            Written::Elsewhere { why, folder } => (folder, format!(" because of this: {why}")),
        };
        let picture = folder.join("image.png");
        Ok(format!(
            "the picture as far as it came is {}{log}{why}",
            picture.display()
        ))
    }

    fn report(&self, image: &Estimate, verdict: Option<&Verdict>) -> Report {
        let options = &self.job.options;
        let plan = self.job.plan;
        let error = match verdict.map(|verdict| &verdict.against) {
            Some((reference, comparison)) => {
                let noise_known = image.variance.is_some() && reference.variance.is_some();
                report::ErrorFigures::new(comparison, reference.spp, noise_known)
            }
            None => report::ErrorFigures {
                mean: image.picture.mean(),
                ..report::ErrorFigures::default()
            },
        };
        Report {
            scene: self.job.scene.name.clone(),
            size: [plan.width, plan.height],
            spp: plan.spp,
            cores: options.cores.into(),
            board: self.origin.boards(),
            images: self.origin.images.clone(),
            backend: self.origin.backend.to_owned(),
            profile: self.profile(),
            integrator: options.integrator().to_string(),
            sampler: options.sampler().to_string(),
            termination: options.termination.to_string(),
            pixels: options.pixels.name().to_owned(),
            seed: plan.seed,
            epsilon: f64::from(plan.epsilon) * 2f64.powi(-self.job.compiled.scale.exponent),
            image_sha256: self.collection.film.sha256(),
            samples: self.collection.film.samples(),
            missing_pixels: self.collection.film.missing(),
            saturated_sums: self.collection.film.saturated(),
            complete: self.collection.end == End::Complete,
            wall_seconds: self.wall.as_secs_f64(),
            peak_memory_bytes: self.memory,
            packets: self.collection.packets,
            cost: self.cost(),
            blind_spots: cycles::unseen(self.recordings),
            error,
            lockstep_error: verdict.and_then(|verdict| verdict.lockstep),
            per_core: {
                let counts = self.origin.counts_instructions;
                let cores = self.collection.cores.iter();
                cores.map(|record| per_core(record, counts)).collect()
            },
        }
    }

    /// What the arithmetic is called.
    fn profile(&self) -> String {
        match self.origin.choice {
            Some(choice) => format!("{} but for {}", self.job.options.profile, choice.word()),
            None => SoftFloat::profile(self.job.options.profile, self.origin.soft_float),
        }
    }

    fn cost(&self) -> Cost {
        let samples = self.collection.film.samples();
        let per_sample = |total: f64| (samples > 0).then(|| total / samples as f64);
        let units = self.collection.cores.iter().map(|core| core.units).sum();
        let meter = self.origin.meter.as_ref();
        let bounds = meter.and_then(|meter| cycles::per_sample(meter, self.recordings, units, samples));
        let [low, likely, high] = bounds.map_or([None; 3], |bounds| bounds.map(Some));
        let instructions = self.collection.ticks() as f64 * INSTRUCTIONS_PER_TICK;
        Cost {
            instructions_per_sample: per_sample(instructions).filter(|_| self.origin.counts_instructions),
            cycles_per_sample: likely,
            cycles_per_sample_low: low,
            cycles_per_sample_high: high,
            rays_per_sample: per_sample(self.collection.rays() as f64),
        }
    }

    /// A few lines for people.
    pub(super) fn summary(&self, report: &Report) -> String {
        let mut text = format!(
            "picture  {} ({}x{}, {} samples per pixel, {} cores)\n",
            self.job.out().join("image.png").display(),
            report.size[0],
            report.size[1],
            report.spp,
            report.cores
        );
        let mut line = |name: &str, said: String| {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{name:8} {said}");
        };
        for warning in tiles_off(report).into_iter().chain(saturated(report)) {
            line("WARNING", warning);
        }
        line("mean", means(report));
        let error = &report.error;
        if let Some(bias) = error.bias {
            let noise = error
                .bias_standard_error
                .map(|noise| format!(" (standard error {:.3} %)", 100.0 * noise));
            let rmse = error.rmse.map(|rmse| format!(", rmse {}", significant(rmse)));
            // Where noise hides the error, the bound is what can be said of it.
            let most = error
                .rmse_at_most
                .map(|most| format!(" (at most {})", significant(most)));
            let [noise, rmse, most] = [noise, rmse, most].map(Option::unwrap_or_default);
            line("bias", format!("{:+.3} %{noise}{rmse}{most}", 100.0 * bias));
        }
        if let (Some(picture), Some(reference)) = (error.standard_error, error.reference_standard_error) {
            line("noise", noise(picture, reference, error));
        }
        if let Some(tiles) = &error.tiles {
            let (failed, tested, bound) = (tiles.failed, tiles.tested, tiles.threshold_z);
            let worst = tiles
                .max_z
                .map_or_else(|| "unbounded".to_owned(), |z| format!("{z:+.2}"));
            line(
                "tiles",
                format!("{failed} of {tested} tests fail (worst z {worst}, bound {bound:.2})"),
            );
        }
        if let Some(lockstep) = &report.lockstep_error {
            let bias = lockstep
                .bias
                .map_or_else(|| "-".to_owned(), |bias| format!("{:+.4} %", 100.0 * bias));
            let noise = lockstep
                .bias_standard_error
                .map(|noise| format!(" (standard error {:.4} %)", 100.0 * noise))
                .unwrap_or_default();
            line(
                "lockstep",
                format!(
                    "bias {bias}{noise}, rms difference {}: arithmetic alone",
                    significant(lockstep.rmse)
                ),
            );
        }
        let cost = &report.cost;
        if let Some(rays) = cost.rays_per_sample {
            let said = match cost.instructions_per_sample {
                Some(instructions) => format!("{instructions:.1} instructions and {rays:.2} rays a sample"),
                None => format!("{rays:.2} rays a sample; only emulated cores count instructions"),
            };
            line("cost", said);
        }
        if let [Some(low), Some(cycles), Some(high)] = [
            cost.cycles_per_sample_low,
            cost.cycles_per_sample,
            cost.cycles_per_sample_high,
        ] {
            line(
                "cycles",
                format!("{cycles:.1} a sample, from {low:.1} to {high:.1} by what the model does not see"),
            );
            let worth_a_line = |spot: &&report::BlindSpot| spot.less + spot.more > 1e-5;
            for spot in report.blind_spots.iter().filter(worth_a_line) {
                let (less, more) = (100.0 * spot.less, 100.0 * spot.more);
                line("unseen", format!("-{less:.3} % to +{more:.3} %: {}", spot.what));
            }
        }
        if let Some((used, size)) = self.collection.stack() {
            line("stack", format!("at most {used} of {size} bytes used"));
        }
        let packets = &report.packets;
        line(
            "packets",
            format!(
                "{} received, {} duplicate ({:.2} %), {} rejected, {} lost",
                packets.received,
                packets.duplicate,
                100.0 * packets.duplicate_share,
                packets.rejected,
                packets.lost
            ),
        );
        let memory = report
            .peak_memory_bytes
            .map_or_else(|| "-".to_owned(), |bytes| format!("{} MiB", bytes >> 20));
        line(
            "time",
            format!(
                "{:.1} s from the first core's start to the last unit; peak memory {memory}",
                report.wall_seconds
            ),
        );
        line("sha256", report.image_sha256.clone());
        if let Some(log) = &self.origin.log {
            line("log", log.display().to_string());
        }
        text.trim_end().to_owned()
    }
}

/// A core's share of the report.
pub(super) fn per_core(record: &CoreRecord, counts_instructions: bool) -> report::Core {
    let stack = record.farewell.filter(|farewell| farewell.stack_size > 0);
    report::Core {
        core: record.core,
        board: record.board.map(|board| board.to_string()),
        units: record.units,
        ticks: counts_instructions.then_some(record.ticks),
        stack_bytes: stack.map(|farewell| farewell.stack_used),
        stack_size: stack.map(|farewell| farewell.stack_size),
        rejected: record.farewell.map(|farewell| farewell.rejected),
        restarts: record.restarts.len(),
        fault: record.trouble().map(|cause| cause.explained()),
    }
}

/// A bar for what takes the host a while; where there is no terminal it stays hidden.
fn bar(name: &'static str, samples: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:9} {wide_bar} {percent}% {eta} left");
    // The template is a constant; were it wrong, the default style would still say how far it is.
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(samples).with_style(style).with_prefix(name)
}

/// What is to be said before all else: the picture is wrong somewhere, and where to look.
fn tiles_off(report: &Report) -> Option<String> {
    let tiles = report.error.tiles.as_ref().filter(|tiles| tiles.failed > 0)?;
    Some(format!(
        "the picture is off by more than noise explains: {} of {} tile tests fail; difference.png shows where",
        tiles.failed, tiles.tested
    ))
}

/// What else is to be said before: light was lost.
fn saturated(report: &Report) -> Option<String> {
    (report.saturated_sums > 0).then(|| {
        format!(
            "{} sums of pixels were greater than a packet holds, and the picture is too dark there: the scene's light is more than \
             its compiler made room for",
            report.saturated_sums
        )
    })
}

fn means(report: &Report) -> String {
    let of = |mean: Option<[f64; 3]>| {
        mean.map(|[r, g, b]| {
            let [mean, r, g, b] = [(r + g + b) / 3.0, r, g, b].map(significant);
            format!("{mean} (red {r}, green {g}, blue {b})")
        })
    };
    let image = of(report.error.mean).unwrap_or_else(|| "-".to_owned());
    match of(report.error.reference_mean) {
        Some(reference) => format!("{image}; reference {reference}"),
        None => image,
    }
}

/// How much of the bias's standard error is whose.
fn noise(picture: f64, reference: f64, error: &report::ErrorFigures) -> String {
    let spp = error
        .reference_spp
        .map(|spp| format!(" at {spp} samples per pixel"));
    let tile = error.reference_tile_noise_share.unwrap_or_default();
    let most = effort::MOST_SHARE;
    let too_much = if reference > most * picture || tile > most {
        "; the reference's is more than half of the picture's: give it more by --reference-spp"
    } else {
        ""
    };
    format!(
        "of the mean {:.3} %, the reference's {:.3} %{}, of a tile {tile:.2} of the picture's{too_much}",
        100.0 * picture,
        100.0 * reference,
        spp.unwrap_or_default(),
    )
}

/// Radiance to five decimals, or to four digits where those would be noughts.
fn significant(radiance: f64) -> String {
    if radiance == 0.0 || radiance.abs() >= 0.001 {
        format!("{radiance:.5}")
    } else {
        format!("{radiance:.3e}")
    }
}
