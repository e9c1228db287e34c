"""A beating heart: from a cine to the curve of its volume, and to a model of how it moves."""

import homolog

homolog.run("sample", "-o", "heart")
template = homolog.make_template("heart/heart-cine-labels.nii.gz", "ventricle.ply", label=1)
beat = homolog.propagate(template, "heart/heart-cine.nii.gz", frame=18)

print("volumes, ml:", *(round(mesh.volume_ml) for mesh in beat["meshes"]))
for phase, volume in (("end_diastole", "end_diastolic_volume_ml"), ("end_systole", "end_systolic_volume_ml")):
    print(f"{phase}: {beat[volume]:.0f} ml, frame {beat[phase]}")
stroke_ml = beat["end_diastolic_volume_ml"] - beat["end_systolic_volume_ml"]
print(f"stroke volume {stroke_ml:.0f} ml, ejection fraction {100 * beat['ejection_fraction']:.0f} %")
systole = homolog.compare(beat["meshes"][7], labels="heart/heart-cine-end-systole-labels.nii.gz", label=1)
print(f"end-systole against the expert: Dice {systole['dice']:.2f}, {systole['assd_mm']:.1f} mm")

model = homolog.model(beat["meshes"], no_align=True)
print(f"{len(model)} modes; the first holds {100 * model.report['explained'][0]:.0f} % of the variance")
print(*(f"{model.mode(0, z).volume_ml:.0f} ml" for z in (-2, 0, 2)), sep=", ")
model.write("beat.h5.json")
homolog.picture_of_modes(model, modes=1, size=(600, 220), ground="light").write("beat.png")
