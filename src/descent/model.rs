//! Which equations of motion a descent follows.

/// A model of the motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Model {
    /// Both bodies accelerate: paper (13), (14).
    #[default]
    Dynamic,
    /// The brake's torque balances the line's pull at every moment: paper (15).
    QuasiSteady,
}

impl Model {
    /// Both models.
    pub const ALL: [Model; 2] = [Model::Dynamic, Model::QuasiSteady];

    /// The name in study files.
    pub fn name(self) -> &'static str {
        match self {
            Model::Dynamic => "dynamic",
            Model::QuasiSteady => "quasi-steady",
        }
    }

    /// The model of a name.
    pub fn from_name(name: &str) -> Option<Model> {
        Self::ALL.into_iter().find(|model| model.name() == name)
    }
}
