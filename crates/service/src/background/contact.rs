//! Models of the machine for contact detection.

use super::Background;
use crate::contact::ContactModel;
use crate::feature::Optional;
use crate::number::ServiceNumber;
use crate::scene::Scene;
use core::borrow::Borrow;

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Answers the tick with a model of the pose that it asks for. A pose without a motion has none: the tick keeps the
    /// last one.
    #[inline(always)]
    pub(super) fn contact_step(&mut self) {
        let Some(receiver) = self.features.contact.get_mut() else {
            return;
        };
        let (Some(pose), Some(contact)) = (receiver.poses.receive(), receiver.coefficients) else {
            return;
        };
        let tick = &self.coefficients.borrow().tick;
        if let Some(model) = ContactModel::at(tick, pose, contact) {
            receiver.models.send(model);
        }
    }
}
