//! Scenes that nobody has made: rooms of six walls, most of which are proved to be one and some are not; a ball for a room; balls
//! under the sky.

use std::fmt::Write;

use fixedmath::random::Lcg64;

use crate::scene::Scene;

/// So many scenes, each with its seed's number for a name. What the scene compiler refuses is left out and drawn anew.
pub fn random_scenes(seed: u64) -> impl Iterator<Item = Scene> {
    (0u64..).filter_map(move |number| {
        let mut draw = Draw(Lcg64::new(
            seed.wrapping_add(number).wrapping_mul(0x9e37_79b9_7f4a_7c15),
        ));
        Scene::parse(&format!("{number}.toml"), &draw.text()).ok()
    })
}

struct Draw(Lcg64);

impl Draw {
    fn number(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * f64::from(self.0.next_fraction()) / 4_294_967_296.0
    }

    /// One of `n` cases.
    fn case(&mut self, n: u32) -> u32 {
        self.number(0.0, n.into()) as u32
    }

    /// A number whose magnitude is as likely to be small as large.
    fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        from * (to / from).powf(self.number(0.0, 1.0))
    }

    fn material(&mut self) -> String {
        let colour = [(); 3].map(|()| self.number(0.1, 0.95));
        match self.case(4) {
            0 => format!("mirror = {colour:?}"),
            1 => format!("glass = {colour:?}\nindex = {}", self.number(1.1, 2.5)),
            _ => format!("diffuse = {colour:?}"),
        }
    }

    fn text(&mut self) -> String {
        let base = [(); 3].map(|()| {
            if self.case(2) == 0 {
                0.0
            } else {
                self.number(-500.0, 500.0)
            }
        });
        let low = [(); 3].map(|()| -self.magnitude(10.0, 120.0));
        let high = [(); 3].map(|()| self.magnitude(10.0, 120.0));
        let mut text = String::from("format = 1\n");
        let within = |draw: &mut Self, i: usize, share: f64| base[i] + draw.number(low[i], high[i]) * share;
        let eye = [0, 1, 2].map(|i| within(self, i, 0.5));
        let look = [(); 3].map(|()| self.number(-1.0, 1.0));
        let _ = write!(
            text,
            "[camera]\nposition = {eye:?}\ndirection = {look:?}\nplane_height = 1\n"
        );
        match self.case(8) {
            0 => self.ball_room(&mut text, base, low, high),
            1 => {}
            _ => self.walls(&mut text, base, low, high),
        }
        let size = (0..3).map(|i| high[i] - low[i]).fold(f64::INFINITY, f64::min);
        // Beside small balls walls are vast, and no room is proved of them.
        let smallest = if self.case(3) == 0 { 0.02 } else { 0.2 };
        for ball in 0..1 + self.case(8) {
            let centre = [0, 1, 2].map(|i| within(self, i, 1.0));
            let radius = self.magnitude(smallest, 0.5) * size;
            let emission = if ball == 0 { 1 } else { 0 };
            let material = self.material();
            let _ = write!(
                text,
                "[[sphere]]\nname = \"ball {ball}\"\ncentre = {centre:?}\nradius = {radius}\n\
                 emission = [{emission}, {emission}, {emission}]\n{material}\n"
            );
        }
        text
    }

    fn ball_room(&mut self, text: &mut String, base: [f64; 3], low: [f64; 3], high: [f64; 3]) {
        let radius = (0..3).map(|i| high[i] - low[i]).fold(1.0, f64::max);
        let material = self.material();
        let _ = write!(
            text,
            "[[sphere]]\nname = \"room\"\nhollow = true\ncentre = {base:?}\nradius = {radius}\n{material}\n"
        );
    }

    fn walls(&mut self, text: &mut String, base: [f64; 3], low: [f64; 3], high: [f64; 3]) {
        let askew = self.case(6) == 0;
        let largest = (0..3).map(|i| high[i] - low[i]).fold(1.0, f64::max);
        for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            let plane = if side > 0.0 { high[axis] } else { low[axis] };
            let radius = if self.case(8) == 0 {
                self.magnitude(5.0, 50.0) * largest
            } else {
                self.number(5_000.0, 10_000.0)
            };
            let mut centre = base;
            centre[axis] += plane - side * radius;
            if askew {
                centre[(axis + 1) % 3] += self.number(-1.0, 1.0);
            }
            let material = self.material();
            let _ = write!(
                text,
                "[[sphere]]\nname = \"wall {axis} {side}\"\nhollow = true\ncentre = {centre:?}\n\
                 radius = {radius}\n{material}\n"
            );
        }
        if self.case(4) == 0 {
            self.ball_room(text, base, low, high);
        }
    }
}
