//! Moves the camera with a body, or with the creatures of a scene.

use rockfall::SphereId;
use rockfall::glam::Vec3;

use super::Viewer;
use crate::subject::Subject;
use crate::whole::motion;
use crate::window::message::Level;

/// Number of spheres above which no body is followed, because its place is read back in every frame.
const MOST_SPHERES: usize = 200_000;

/// What the camera moves with, and where that was in the last frame.
#[derive(Clone, Debug)]
pub(super) struct Follow {
    target: Subject,
    last: Vec3,
}

impl Viewer {
    /// Whether the camera moves with a body.
    pub fn is_following(&self) -> bool {
        self.follow.is_some()
    }

    /// Starts to follow the picked body, or the creatures if none is picked. Ends it if the camera follows that already.
    pub(super) fn toggle_follow(&mut self) {
        let scene = self.session.simulation_ref().scene();
        let picked = self.session.picked().filter(|body| motion(scene, *body).is_some()).map(Subject::Body);
        let target = picked.or_else(|| Subject::creatures(scene));
        let same = self.follow.as_ref().is_some_and(|follow| target.is_none() || target.as_ref() == Some(&follow.target));
        if same {
            self.follow = None;
            self.session.tell(Level::Note, "the camera follows nothing any more");
        } else if let Some(target) = target {
            self.follow_target(target);
        } else {
            self.session.tell(Level::Note, "click the body that the camera is to follow first");
        }
    }

    fn follow_target(&mut self, target: Subject) {
        if self.session.simulation_ref().scene().counts().spheres > MOST_SPHERES {
            self.session.tell(Level::Note, "the scene is too large to follow a body");
            return;
        }
        self.follow = self.place_of(&target).map(|last| Follow { target, last });
    }

    /// Follows the sphere that [`Viewer::find`] finds in a scene that was opened, which is then in the middle of the picture, or else
    /// the creatures of the scene.
    pub fn follow_initially(&mut self) {
        self.follow = None;
        let scene = self.session.simulation_ref().scene();
        let found = self.find.as_ref().and_then(|find| find(scene)).map(|sphere| Subject::of(scene, sphere));
        if let Some(target) = found.or_else(|| Subject::creatures(scene)) {
            self.follow_target(target);
        }
        self.look_at_found();
    }

    /// Picks the first of the spheres that [`Viewer::plotted`] finds in a scene that was opened, and keeps the others in the plots.
    pub fn plot_initially(&mut self) {
        let scene = self.session.simulation_ref().scene();
        let spheres: Vec<SphereId> = self.plotted.iter().filter_map(|find| find(scene)).collect();
        if !spheres.is_empty() {
            self.session.set_plotted(&spheres);
        }
    }

    /// Moves the camera so that a sphere that was found is in the middle of the picture.
    fn look_at_found(&mut self) {
        if let (Some(_), Some(Follow { target: Subject::Body(_), last })) = (&self.find, &self.follow) {
            let moved = *last - self.camera.target;
            self.camera.eye += moved;
            self.camera.target += moved;
        }
    }

    /// The camera shows the initial scene again, so it has to move to where the body is now.
    pub(super) fn follow_from_start(&mut self) {
        let scene = &self.session.source().scene;
        if let Some(follow) = &mut self.follow
            && let Some((start, _)) = follow.target.motion(scene)
        {
            follow.last = start;
        }
        self.look_at_found();
    }

    /// Returns where the body is in the picture, which is drawn between the last two states.
    fn place_of(&mut self, target: &Subject) -> Option<Vec3> {
        let part = if self.session.running() { 1.0 - self.session.pace.alpha() } else { 0.0 };
        let before = part * self.session.pace.time_step;
        let scene = self.session.simulation().sync().ok()?;
        target.motion(scene).map(|(position, velocity)| position - before * velocity)
    }

    /// Moves the camera with the body that it follows. Creatures are followed along the ground only.
    pub fn follow(&mut self) {
        if self.session.device_failed() {
            return;
        }
        let Some(mut follow) = self.follow.take() else { return };
        let Some(place) = self.place_of(&follow.target) else { return };
        let mut moved = place - follow.last;
        if !moved.is_finite() {
            return;
        }
        let ignored = follow.target.ignored(self.session.simulation_ref().scene());
        moved -= moved.dot(ignored) * ignored;
        self.camera.eye += moved;
        self.camera.target += moved;
        if moved != Vec3::ZERO {
            self.limits = None;
        }
        follow.last = place;
        self.follow = Some(follow);
    }
}
