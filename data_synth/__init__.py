"""What the world is: procedural shapes, faces, lights, environments and cameras, in numpy alone."""
