//! Which equations of motion and of heat a descent follows.

/// A model of the motion and of the heat.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Model {
    /// Both bodies accelerate: paper (13), (14); the heat in three nodes: paper (16), (17).
    #[default]
    Dynamic,
    /// The brake's torque balances the line's pull at every moment: paper (15); three nodes.
    QuasiSteady,
    /// As [`Model::Dynamic`], with temperature over the radius and across the film (see [`crate::physics::film`]).
    DetailedDynamic,
    /// As [`Model::QuasiSteady`], with temperature over the radius and across the film.
    DetailedQuasiSteady,
}

impl Model {
    /// All models.
    pub const ALL: [Model; 4] =
        [Model::Dynamic, Model::QuasiSteady, Model::DetailedDynamic, Model::DetailedQuasiSteady];

    /// Those with the heat in three nodes.
    pub const THREE_NODES: [Model; 2] = [Model::Dynamic, Model::QuasiSteady];

    /// The name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Model::Dynamic => "dynamic",
            Model::QuasiSteady => "quasi-steady",
            Model::DetailedDynamic => "detailed-dynamic",
            Model::DetailedQuasiSteady => "detailed-quasi-steady",
        }
    }

    /// Whether temperature is resolved over the radius and across the film.
    pub fn is_detailed(self) -> bool {
        matches!(self, Model::DetailedDynamic | Model::DetailedQuasiSteady)
    }

    /// The model with the same motion and the other treatment of heat.
    #[must_use]
    pub fn with_other_heat(self) -> Self {
        match self {
            Model::Dynamic => Model::DetailedDynamic,
            Model::QuasiSteady => Model::DetailedQuasiSteady,
            Model::DetailedDynamic => Model::Dynamic,
            Model::DetailedQuasiSteady => Model::QuasiSteady,
        }
    }

    /// The model of a name.
    pub fn from_name(name: &str) -> Option<Model> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}
