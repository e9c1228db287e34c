"""Measures a cohort, scores a new subject, and tests whether two groups differ in shape."""

import homolog

# Eight kidneys, of which every other one is made longer.
shapes, rows = {}, []
for k in range(1, 9):
    truth = homolog.phantom("kidney", k)["truth"][0]
    long = k % 2 == 0
    shapes[f"case_{k}"] = truth.with_points(truth.points * [1, 1, 1.25 if long else 1])
    rows.append({"name": f"case_{k}", "group": "long" if long else "short"})

for case in homolog.measure(shapes)["cases"]:
    poles_mm = case["distances_mm"]["superior pole to inferior pole"]
    print(f"{case['case']}: {case['volume_ml']:.0f} ml, {poles_mm:.0f} mm from pole to pole")

found = homolog.test(shapes, "shape ~ group", covariates=rows, permutations=199)
for term in found["terms"]:
    print(f"{term['name']}: R² {term['r2']:.2f}, p {term['p']}")

model = homolog.model([mesh for name, mesh in shapes.items() if name != "case_1"])
score = model.score(shapes["case_1"])
print(f"case_1 lies {score['distance']:.1f} σ from the mean, {score['residual_mm']:.1f} mm beyond the model")
