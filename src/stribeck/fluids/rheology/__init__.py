"""Laws of liquids, one file each: viscosity and density under pressure, stress at a shear rate."""
