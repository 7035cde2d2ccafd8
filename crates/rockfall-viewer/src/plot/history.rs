//! What plots have seen.

use std::ops::Range;

use rockfall::{Result, Simulation};

use super::axes::{extent, widened};
use super::{ABSENT, Graph, Quantity};
use crate::palette::Rgb;

/// Number of states above which every second one is forgotten.
const MOST: usize = 4000;
/// Number of states along the axis of the time.
const STATES: f64 = 400.0;
/// Free part of a vertical axis above and below the lines.
const ROOM: f64 = 0.06;

/// Plots, and the states that they show.
#[derive(Debug, Default)]
pub struct Plots {
    graphs: Vec<Graph>,
    /// First and last time of the axes, if they are known before.
    span: Option<[f64; 2]>,
    /// Ranges of the values that are known before.
    ranges: Vec<Option<[f64; 2]>>,
    pub(super) before: Vec<f64>,
    pub(super) now: Vec<f64>,
    samples: Vec<Sample>,
    /// Whether each line of all graphs ever had another value than 0.
    used: Vec<bool>,
}

/// The values of all lines of all graphs at a time.
#[derive(Clone, Debug)]
struct Sample {
    time: f64,
    values: Vec<f64>,
}

impl Plots {
    pub(crate) fn new(graphs: Vec<Graph>) -> Self {
        Self { ranges: vec![None; graphs.len()], graphs, ..Self::default() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.graphs.is_empty()
    }

    /// Number of plots.
    pub fn len(&self) -> usize {
        self.graphs.len()
    }

    pub(crate) fn graphs(&self) -> &[Graph] {
        &self.graphs
    }

    /// Takes the values of the present state.
    pub(crate) fn update(&mut self, simulation: &mut Simulation) -> Result<()> {
        self.now.clear();
        for graph in &mut self.graphs {
            self.now.extend(graph.values(simulation)?);
        }
        Ok(())
    }

    pub(crate) fn remember(&mut self) {
        self.before.clone_from(&self.now);
    }

    /// Adds the state that is shown: that of a time, of which `back` comes from the state before.
    pub(crate) fn record(&mut self, time: f64, back: f64) {
        if self.is_empty() {
            return;
        }
        let before = if self.before.len() == self.now.len() { &self.before } else { &self.now };
        // Without the condition, a body that is no longer there in the present state would have no value in that before.
        let between = |(now, before): (&f64, &f64)| if back > 0.0 { now + back * (before - now) } else { *now };
        let values: Vec<f64> = self.now.iter().zip(before).map(between).collect();
        self.used.resize(values.len(), false);
        self.used.iter_mut().zip(&values).for_each(|(used, value)| *used |= *value != 0.0);
        let kept = self.samples.partition_point(|sample| sample.time < time);
        self.samples.truncate(kept);
        self.samples.push(Sample { time, values });
        if self.samples.len() > MOST {
            let mut is_kept = false;
            self.samples.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }
    }

    /// Fixes the axes of a film from what was seen of it, and forgets that.
    pub(crate) fn fix(&mut self, span: [f64; 2]) {
        self.ranges = (0..self.len()).map(|graph| self.extent(graph)).collect();
        (self.span, self.samples) = (Some(span), Vec::new());
    }

    /// Time between the states that plots need, in s.
    pub(crate) fn interval(&self) -> Option<f64> {
        let [from, to] = self.span.filter(|_| !self.is_empty())?;
        Some((to - from) / STATES)
    }

    /// The places of the lines of a graph among those of all graphs.
    fn places(&self, graph: usize) -> Range<usize> {
        let first: usize = self.graphs[..graph].iter().map(|graph| graph.lines.len()).sum();
        first..first + self.graphs[graph].lines.len()
    }

    /// The lines that a plot shows: not the energy of springs or contacts where there never was any.
    pub(crate) fn lines(&self, graph: usize) -> impl Iterator<Item = (usize, &(String, Rgb))> {
        let used = self.used.get(self.places(graph)).unwrap_or_default();
        let graph = &self.graphs[graph];
        let is_shown = move |line: usize, name: &str| {
            let may_be_absent = graph.quantity == Quantity::Energy && ABSENT.contains(&name);
            !may_be_absent || used.get(line).is_some_and(|used| *used)
        };
        graph.lines.iter().enumerate().filter(move |(line, (name, _))| is_shown(*line, name))
    }

    /// The values of the lines of a graph in the states.
    fn of(&self, graph: usize) -> impl Iterator<Item = (f64, &[f64])> {
        let lines = self.places(graph);
        self.samples.iter().filter_map(move |sample| Some((sample.time, sample.values.get(lines.clone())?)))
    }

    fn extent(&self, graph: usize) -> Option<[f64; 2]> {
        let seen = extent(self.of(graph).flat_map(|(_, values)| values.iter().copied()));
        extent(seen.into_iter().chain(self.ranges[graph]).flatten())
    }

    /// The range of the time.
    pub(crate) fn times(&self) -> [f64; 2] {
        let seen = extent(self.samples.iter().map(|sample| sample.time));
        let [from, to] = self.span.or(seen).unwrap_or([0.0; 2]);
        [from, if to > from { to } else { from + 1.0 }]
    }

    /// The range of the values of a graph.
    pub(crate) fn range(&self, graph: usize) -> [f64; 2] {
        let [low, high] = widened(self.extent(graph).unwrap_or([0.0; 2]));
        let room = ROOM * (high - low);
        [low - room, high + room]
    }

    /// The points of a line of a graph.
    pub(crate) fn points(&self, graph: usize, line: usize) -> impl Iterator<Item = [f64; 2]> {
        self.of(graph).map(move |(time, values)| [time, values[line]])
    }
}
