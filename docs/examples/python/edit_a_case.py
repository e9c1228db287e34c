"""A case by program: a fit, a stroke, undo, and the file that keeps all of it."""

import homolog

subject = homolog.phantom("kidney", 2)
with homolog.Case.create("built-in:kidney", "phantom:kidney:2", "kidney.homolog") as case:
    case.fit(subject["labels"])
    pole = case.points()[0]
    report = case.pull(pole, pole + [0, 0, 4], sigma_mm=12)
    print(f"the stroke moved its point by {report['moved_mm']:.1f} mm")
    print("undo would take back:", case.undo_names())
    case.undo()
    case.mesh().write("kidney.ply")

agreement = homolog.compare("kidney.ply", other=subject["truth"][0])
print(f"Dice {agreement['dice']:.3f}")
assert agreement["dice"] > 0.98
