"""Raw samples of a boot's inertial unit become displacements, as a PDR unit would report them."""
