//! An orbit camera: every movement returns whether the view changed; only [`Camera::fit`] is animated, and a movement by
//! nothing leaves the animation running.

#[cfg(test)]
mod tests;

use glam::camera::rh::proj::opengl;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec2, Vec3, Vec4};

/// Vertical field of view \[radians\]: a long lens, as in a clinical photograph.
const FIELD_OF_VIEW: f32 = 0.48;
/// Orbit per screen point of a drag \[radians\].
const ORBIT_RATE: f32 = 0.008;
/// Range of the elevation \[radians\]: the eye stays above the wall.
const ELEVATION: (f32, f32) = (0.0, 1.55);
/// Ranges of azimuth and elevation before a standing patient \[radians\]: the eye stays in front of the wall.
const STANDING_AZIMUTH: (f32, f32) = (-std::f32::consts::PI, 0.0);
const STANDING_ELEVATION: (f32, f32) = (-1.2, 1.2);
/// Range of the distance \[mm\].
const DISTANCE_MM: (f32, f32) = (40.0, 3000.0);
/// Greatest coordinates of the target \[mm\].
const TARGET_MM: Vec3 = Vec3::splat(400.0);
/// Heights of the target above the wall \[radius of the body\]: obliquely the body is in the middle of the view, slightly below,
/// because of the buttons above; along the wall the dome is.
const OBLIQUE_HEIGHT: f32 = 0.03;
const LEVEL_HEIGHT: f32 = 0.22;
/// Range of the aspect ratio in which the distance of a standard view follows the ratio \[-\].
const ASPECT: (f32, f32) = (0.2, 1.15);
/// Room around a body seen from the front, for its nearer parts and the controls above \[-\].
const FRONT_MARGIN: f32 = 1.08;
/// Room around a body before a standing patient, whose nearer parts are larger \[-\].
const STANDING_MARGIN: f32 = 1.12;
/// Duration of [`Camera::fit`] \[s\].
const EASE_SECONDS: f32 = 0.35;

/// Position of the eye on a sphere about a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of the view \[mm\].
    pub target: Vec3,
    /// Angle about z \[radians\], from +x counter-clockwise.
    pub azimuth: f32,
    /// Angle above the wall \[radians\].
    pub elevation: f32,
    /// Distance from eye to target \[mm\].
    pub distance: f32,
}

/// A standard view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From the front, the head up.
    Front,
    /// From the patient's side, the head up.
    Side,
    /// From the head, the chest wall down.
    Top,
    /// Three-quarter view.
    All,
}

/// A standard pose of a standing patient, the head up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// From the front.
    Front,
    /// From the front, turned by 40° to the patient's side.
    ThreeQuarter,
    /// From the patient's side.
    Side,
    /// [`Self::ThreeQuarter`], turned to the other side.
    OtherThreeQuarter,
    /// From the other side.
    OtherSide,
}

impl Standing {
    /// The poses of one side.
    pub const OF_SIDE: [Self; 3] = [Self::Front, Self::ThreeQuarter, Self::Side];
    /// All poses.
    pub const ALL: [Self; 5] = {
        let [front, three_quarter, side] = Self::OF_SIDE;
        [front, three_quarter, side, Self::OtherThreeQuarter, Self::OtherSide]
    };

    /// Angle about the patient's upright axis from the side to the front \[radians\], clockwise seen from above.
    fn azimuth(self) -> f32 {
        let turned = match self {
            Self::Front => 0.0,
            Self::ThreeQuarter => 40.0_f32.to_radians(),
            Self::Side => std::f32::consts::FRAC_PI_2,
            Self::OtherThreeQuarter => -(40.0_f32.to_radians()),
            Self::OtherSide => -std::f32::consts::FRAC_PI_2,
        };
        turned - std::f32::consts::FRAC_PI_2
    }
}

/// What a camera shows: a ball on the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ball {
    /// Radius \[mm\].
    pub radius_mm: f32,
    /// Height of the middle of the wall below it over the plane z = 0 \[mm\]: 0 or less, a curved chest falls away.
    pub middle_mm: f32,
}

impl From<f32> for Ball {
    /// A ball of this radius \[mm\] on a flat wall.
    fn from(radius_mm: f32) -> Self {
        Self { radius_mm, middle_mm: 0.0 }
    }
}

/// An orbit camera with a perspective lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pose: Pose,
    ease: Option<Ease>,
    is_mirrored: bool,
    /// Is the head up on the screen? Else the wall's normal is.
    is_standing: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Ease {
    from: Pose,
    to: Pose,
    done: f32,
}

/// A ray of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start \[mm\].
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

impl Camera {
    /// A three-quarter view of a ball on the wall.
    #[must_use]
    pub fn new(ball: impl Into<Ball>, aspect: f32) -> Self {
        Self {
            pose: fitted(ball.into(), aspect),
            ease: None,
            is_mirrored: false,
            is_standing: false,
        }
    }

    /// A view of a ball on the wall of a standing patient, the whole ball in sight.
    #[must_use]
    pub fn standing(ball: impl Into<Ball>, aspect: f32, standing: Standing) -> Self {
        let ball = ball.into();
        let target = Vec3::new(0.0, 0.0, LEVEL_HEIGHT * ball.radius_mm + ball.middle_mm);
        let half_angle = (0.5 * FIELD_OF_VIEW).tan() * aspect.clamp(ASPECT.0, 1.0);
        let distance = STANDING_MARGIN * ball.radius_mm / half_angle;
        let pose = Pose { target, azimuth: standing.azimuth(), elevation: 0.0, distance };
        Self { pose, is_standing: true, ..Self::new(ball, aspect) }
    }

    /// The same view of another place \[mm\].
    #[must_use]
    pub fn moved_to(mut self, target: Vec3) -> Self {
        self.pose.target = target;
        self
    }

    /// The view turned about the upright axis \[radians\].
    #[must_use]
    pub fn turned_by(mut self, azimuth: f32) -> Self {
        self.pose.azimuth += azimuth;
        self
    }

    /// A direction of the frame of azimuth and elevation in the world.
    fn turned(&self, v: Vec3) -> Vec3 {
        if self.is_standing { Vec3::new(v.x, v.z, -v.y) } else { v }
    }

    /// Shows the mirror image in the patient's plane of symmetry: of a left breast a right one. Poses, rays and points stay those of
    /// the left one.
    pub fn mirror(&mut self, is_mirrored: bool) {
        self.is_mirrored = is_mirrored;
    }

    /// +1, of a mirror image −1: along the screen's right.
    fn hand(&self) -> f32 {
        if self.is_mirrored { -1.0 } else { 1.0 }
    }

    /// The current pose.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Orbits by a drag in screen points. Returns whether the view changed.
    pub fn drag(&mut self, delta: Vec2) -> bool {
        if delta == Vec2::ZERO {
            return false;
        }
        let before = *self;
        self.ease = None;
        let azimuth = self.pose.azimuth - self.hand() * delta.x * ORBIT_RATE;
        let elevation = self.pose.elevation + delta.y * ORBIT_RATE;
        (self.pose.azimuth, self.pose.elevation) = if self.is_standing {
            let (least, most) = STANDING_ELEVATION;
            let azimuth = azimuth.clamp(STANDING_AZIMUTH.0, STANDING_AZIMUTH.1);
            (azimuth, elevation.clamp(least, most))
        } else {
            (azimuth, elevation.clamp(ELEVATION.0, ELEVATION.1))
        };
        *self != before
    }

    /// Moves the target with the pointer; `height` is the viewport's height in the delta's units. Returns whether the
    /// view changed.
    pub fn pan(&mut self, delta: Vec2, height: f32) -> bool {
        if delta == Vec2::ZERO {
            return false;
        }
        let before = *self;
        self.ease = None;
        let scale = 2.0 * self.pose.distance * (0.5 * FIELD_OF_VIEW).tan() / height.max(1.0);
        let (right, up) = self.right_and_up();
        self.pose.target += (up * delta.y - right * delta.x) * scale;
        self.pose.target = self.pose.target.clamp(-TARGET_MM, TARGET_MM);
        // The wall is seen from above.
        self.pose.target.z = self.pose.target.z.max(before.pose.target.z.min(0.0));
        *self != before
    }

    /// Divides the distance by a factor; what is seen at the point of the viewport (both coordinates from −1 to 1, y up),
    /// at the depth of the target, stays there. Returns whether the view changed.
    pub fn zoom(&mut self, factor: f32, at: Vec2, aspect: f32) -> bool {
        #[expect(clippy::float_cmp, reason = "exactly one where no device moves")]
        let is_movement = factor.is_finite() && factor > 0.0 && factor != 1.0;
        if !is_movement {
            return false;
        }
        let before = *self;
        self.ease = None;
        let distance = (self.pose.distance / factor).clamp(DISTANCE_MM.0, DISTANCE_MM.1);
        let scale = (self.pose.distance - distance) * (0.5 * FIELD_OF_VIEW).tan();
        let (right, up) = self.right_and_up();
        self.pose.target += (right * at.x * aspect + up * at.y) * scale;
        self.pose.target = self.pose.target.clamp(-TARGET_MM, TARGET_MM);
        self.pose.distance = distance;
        *self != before
    }

    /// The part of a zoom factor after which the eye is still outside of the cylinder of [`Self::keep_outside`]; 1 where the eye
    /// is at the cylinder.
    #[must_use]
    pub fn zoom_outside(
        &self,
        factor: f32,
        at: Vec2,
        aspect: f32,
        radius_mm: f32,
        height_mm: f32,
    ) -> f32 {
        let is_outside = |factor: f32| {
            let mut zoomed = *self;
            zoomed.zoom(factor, at, aspect);
            let eye = zoomed.eye();
            eye.z >= height_mm || eye.truncate().length() >= radius_mm
        };
        if factor.is_nan() || factor <= 1.0 || is_outside(factor) {
            return factor;
        }
        let (mut outside, mut inside) = (1.0, factor);
        for _ in 0..24 {
            let middle = 0.5 * (outside + inside);
            *(if is_outside(middle) { &mut outside } else { &mut inside }) = middle;
        }
        // A view that creeps on is no view at rest.
        if outside < 1.001 { 1.0 } else { outside }
    }

    /// Moves the eye back along the line of sight until the eye is outside of a cylinder that stands on the wall about the
    /// origin: the tissue. An animation is left alone.
    pub fn keep_outside(&mut self, radius_mm: f32, height_mm: f32) {
        if self.ease.is_some() {
            return;
        }
        let eye = self.eye();
        if eye.z >= height_mm || eye.truncate().length() >= radius_mm {
            return;
        }
        let back = (eye - self.pose.target) / self.pose.distance;
        // Through the top, or through the side: |eye + t back| = radius in the plane of the wall.
        let top = if back.z > 0.0 { (height_mm - eye.z) / back.z } else { f32::INFINITY };
        let (across, along) = (back.truncate(), eye.truncate());
        let (a, b) = (across.length_squared(), across.dot(along));
        let c = along.length_squared() - radius_mm * radius_mm;
        let side = (-b + (b * b - a * c).sqrt()) / a;
        let step = if side.is_finite() { top.min(side) } else { top };
        if step.is_finite() {
            self.pose.distance = (self.pose.distance + step).min(DISTANCE_MM.1);
        }
    }

    /// Starts the animation to a view of a ball. Between a lying and a standing patient there is none.
    pub fn fit(&mut self, ball: impl Into<Ball>, aspect: f32, view: View) -> bool {
        let ball = ball.into();
        let quarter = std::f32::consts::FRAC_PI_2;
        let fitted = fitted(ball, aspect);
        let target = Vec3::new(0.0, 0.0, LEVEL_HEIGHT * ball.radius_mm + ball.middle_mm);
        let level = Pose { target, elevation: 0.0, ..fitted };
        let to = match view {
            View::Front => {
                let distance = fitted.distance * front_room(aspect);
                Pose { azimuth: -quarter, elevation: ELEVATION.1, distance, ..fitted }
            }
            View::Side => Self::standing(ball, aspect, Standing::Side).pose,
            View::Top => Pose { azimuth: quarter, ..level },
            View::All => fitted,
        };
        let is_standing = view == View::Side;
        if is_standing != self.is_standing {
            (self.pose, self.is_standing, self.ease) = (to, is_standing, None);
            return true;
        }
        if self.pose == to {
            return false;
        }
        // The shorter rotation.
        let turns = ((self.pose.azimuth - to.azimuth) / std::f32::consts::TAU).round();
        self.pose.azimuth -= turns * std::f32::consts::TAU;
        self.ease = Some(Ease { from: self.pose, to, done: 0.0 });
        true
    }

    /// Is a fit running?
    #[must_use]
    pub fn is_easing(&self) -> bool {
        self.ease.is_some()
    }

    /// Continues a fit by a time step \[s\]. Returns whether the view changed.
    pub fn ease(&mut self, seconds: f32) -> bool {
        let Some(ease) = &mut self.ease else { return false };
        ease.done = (ease.done + seconds.max(0.0) / EASE_SECONDS).min(1.0);
        let t = 1.0 - (1.0 - ease.done).powi(3);
        let (a, b) = (ease.from, ease.to);
        self.pose = Pose {
            target: a.target.lerp(b.target, t),
            azimuth: a.azimuth + (b.azimuth - a.azimuth) * t,
            elevation: a.elevation + (b.elevation - a.elevation) * t,
            distance: a.distance + (b.distance - a.distance) * t,
        };
        if ease.done >= 1.0 {
            self.pose = b;
            self.ease = None;
        }
        true
    }

    /// The eye \[mm\].
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        let (sin_a, cos_a) = self.pose.azimuth.sin_cos();
        let (sin_e, cos_e) = self.pose.elevation.sin_cos();
        let back = self.turned(Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e));
        self.pose.target + self.pose.distance * back
    }

    /// World directions of the screen's right and up.
    #[must_use]
    pub fn right_and_up(&self) -> (Vec3, Vec3) {
        let (right, up) = self.light();
        (self.hand() * right, up)
    }

    /// World directions that the light turns with: right and up on the screen of the image that is not mirrored.
    #[must_use]
    pub fn light(&self) -> (Vec3, Vec3) {
        let forward = (self.pose.target - self.eye()).normalize();
        let (sin_a, cos_a) = self.pose.azimuth.sin_cos();
        let right = self.turned(Vec3::new(-sin_a, cos_a, 0.0));
        (right, right.cross(forward))
    }

    /// The transformation from world to clip space (OpenGL: depth −1 to 1).
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let near = (self.pose.distance * 0.05).max(1.0);
        let far = self.pose.distance + 1500.0;
        let (_, up) = self.light();
        Mat4::from_scale(Vec3::new(self.hand(), 1.0, 1.0))
            * opengl::perspective(FIELD_OF_VIEW, aspect, near, far)
            * look_at_mat4(self.eye(), self.pose.target, up)
    }

    /// The ray through a point of the viewport, both coordinates from −1 to 1, y up.
    #[must_use]
    pub fn ray(&self, point: Vec2, aspect: f32) -> Ray {
        let world_from_clip = self.clip_from_world(aspect).inverse();
        let far: Vec4 = world_from_clip * Vec4::new(point.x, point.y, 1.0, 1.0);
        let origin = self.eye();
        Ray { origin, direction: (far.truncate() / far.w - origin).normalize() }
    }

    /// The viewport coordinates of a world point, −1 to 1; `None` behind the eye.
    #[must_use]
    pub fn project(&self, point: Vec3, aspect: f32) -> Option<Vec2> {
        let clip = self.clip_from_world(aspect) * point.extend(1.0);
        (clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w)
    }
}

fn fitted(Ball { radius_mm, middle_mm }: Ball, aspect: f32) -> Pose {
    let half_angle = (0.5 * FIELD_OF_VIEW).tan() * aspect.clamp(ASPECT.0, ASPECT.1);
    Pose {
        target: Vec3::new(0.0, 0.0, OBLIQUE_HEIGHT * radius_mm + middle_mm),
        azimuth: -1.05,
        elevation: 0.5,
        distance: (1.14 * radius_mm / half_angle).clamp(DISTANCE_MM.0, DISTANCE_MM.1),
    }
}

/// Distance of a view from the front over that of the three-quarter view, which sees the body foreshortened in height.
fn front_room(aspect: f32) -> f32 {
    ASPECT.1.min(aspect.max(1.0)) * FRONT_MARGIN
}
