"""The coupled equations of gap, contact pressure and fluid pressure on a mesh, with their error estimate."""
