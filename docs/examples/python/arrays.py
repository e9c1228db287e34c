"""Arrays in and out: a mask from numpy, its mesh as arrays, and the mesh as a mask again."""

import numpy

import homolog

# A ball of 30 mm on a grid of 1 × 1 × 2 mm. The first index runs along x.
i, j, k = numpy.indices((80, 80, 40))
mask = (i - 40) ** 2 + (j - 40) ** 2 + (2 * (k - 20)) ** 2 < 30**2
labels = homolog.LabelMap(mask.astype(numpy.uint8), spacing_mm=(1, 1, 2), origin_mm=(-40, -40, -40), names={1: "ball"})

template = homolog.make_template(labels, "ball.ply", vertices=500)
radii = numpy.linalg.norm(template.points, axis=1)  # a view: nothing is copied
print(f"{len(template)} vertices, radius {radii.mean():.2f} ± {radii.std():.2f} mm")
assert abs(radii.mean() - 30) < 0.5

larger = template.with_points(template.points * 1.1)
voxels = larger.label_map(labels).array
print(f"{voxels.sum()} voxels, {mask.sum()} before")
assert 1.2 < voxels.sum() / mask.sum() < 1.45
