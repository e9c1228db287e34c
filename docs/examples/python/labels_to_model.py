"""From label maps to a shape model. The label maps are phantoms; take your own files in their place."""

import homolog

maps = [homolog.phantom("kidney", k)["labels"] for k in (1, 2, 3, 4)]
fits = [homolog.fit("built-in:kidney", labels) for labels in maps]
model = homolog.model([fit for fit in fits if not fit.doubtful])
model.write("kidney.h5")
print(f"{len(model)} modes hold 95 % of the variance; the first has {model.variances[0]:.0f} mm²")
model.mode(0, +2).write("longer.ply")
