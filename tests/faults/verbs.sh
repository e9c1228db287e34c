# Sourced by faults.sh and devices.sh, which set program and work: inputs in $work/in, and each verb that writes with what it is
# given. What is called old.* is written.
stop() { echo "faults: $1" >&2; exit 1; }

# Inputs: two fitted kidneys and their model, a case with a stroke, a study, a cine of two frames.
mkdir "$work/in" && cd "$work/in" || exit 1
for k in 1 2 3; do "$program" phantom kidney --subject $k -o . > /dev/null || stop "no phantom"; done
ln kidney-1-truth.ply a.ply; ln kidney-2-truth.ply b.ply; ln kidney-3-truth.ply c.ply
printf "%s" "{\"homolog_recipe\":1,\"measurements\":[{\"name\":\"v\",\"kind\":\"volume\"}]}" > recipe.json
ln kidney-1-image.nii.gz image.nii.gz; ln kidney-1-labels.nii.gz mask.nii.gz
"$program" study user built-in:kidney --mask mask.nii.gz --pulls 2 -o case.homolog > /dev/null || stop "no case"
"$program" model a.ply b.ply c.ply -o m.h5 > /dev/null || stop "no model"
printf '%s\n' '{"homolog":1,"volume":"image.nii.gz","template":"a.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[0,0,0]}}' \
  '{"tool":"pull","at":[-21,20,-9],"to":[-20,19,-9],"sigma_mm":10}' > imaged.homolog
printf '{"homolog_study":1,"cases":[{"file":"a.ply"},{"file":"b.ply"},{"file":"c.ply"}]}\n' > s.study.json
"$program" convert a.ply corners.obj > /dev/null || stop "no obj"
awk '/^v /{v[n++]=$2" "$3" "$4} END{print "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4"; for(k=0;k<4;++k) print k+1, v[int(k*n/4)]
  print "$EndNodes\n$Elements\n1\n1 4 0 1 2 3 4\n$EndElements"}' corners.obj > tets.msh
printf 'name,age\na,1\nb,2\nc,4\n' > t.csv
printf 'vertex,v\n1,1\n3,2\n' > v.csv
printf '{"homolog_set":1,"structures":[{"name":"A","value":1,"template":"a.ply"},{"name":"B","value":2,"template":"a.ply"}]}\n' > two.set.json

if [ "${which:-}" = all ]; then
  "$program" phantom ventricle --subject 1 -o . > /dev/null || stop "no cine"
  mv ventricle-1-image.nii.gz cine.nii.gz; mv ventricle-1-truth-00.ply ventricle.ply; rm ventricle-1-*
fi

# A verb, and what it is given. Verbs that take seconds stand behind "slow".
quick=(
  "convert|a.ply old.ply" "convert|a.ply old.vtk" "convert|a.ply old.vtp" "convert|a.ply old.vtu" "convert|a.ply old.surf.gii" "convert|a.ply old.msh" "convert|a.ply old.stl" "convert|image.nii.gz old.nrrd"
  "convert|image.nii.gz old.nii.gz" "convert|image.nii.gz old.mha"
  "mirror|a.ply -o old.ply" "tets|tets.msh b.ply --template a.ply -o tets" "label-map|a.ply --like image.nii.gz -o old.nii.gz" "repair-mesh|a.ply -o old.obj"
  "replay|case.homolog -o old.ply" "measure|a.ply b.ply --csv old.csv" "measure|a.ply b.ply --recipe recipe.json --csv old.csv" "landmarks|a.ply b.ply --vertices -o old.tps"
  "observers|a.ply b.ply --csv old.csv" "model|a.ply b.ply c.ply -o old.h5" "model|a.ply b.ply c.ply -o old.h5.json --csv tables --aligned aligned"
  "evaluate|a.ply b.ply c.ply --samples 2 --csv old.csv" "score|a.ply --model m.h5 -o scores" "phantom|kidney --subject 1 -o phantom" "fit|built-in:kidney --mask mask.nii.gz -o old.ply"
  "test|a.ply b.ply c.ply --covariates t.csv --formula size~age --csv tables"
  "snap|a.ply --image image.nii.gz -o old.ply" "snap|imaged.homolog -o old.ply" "refine|case.homolog -o old.ply" "sample|-o sample"
  "study make|mask.nii.gz --template a.ply -o old.study.json" "set rename|two.set.json B C -o old.set.json"
  "set share|two.set.json A B -o old.set.json" "report|s.study.json -o old.html"
)
slow=(
  "set make|mask.nii.gz --all --vertices 300 -o old.set.json"
  "template|mask.nii.gz -o old.ply --vertices 300" "study user|built-in:kidney --mask mask.nii.gz --pulls 2 -o old.homolog"
  "fit|built-in:kidney --mask kidney-1-labels.nii.gz kidney-2-labels.nii.gz -o fitted"
  "demo|--headless -o demo" "picture correspondence|a.ply b.ply -o old.png" "picture modes|m.h5 -o old.png"
  "picture case|case.homolog -o old.png" "picture window|case.homolog -o old.png" "picture study|s.study.json -o old.png"
  "picture map|a.ply --property v --values v.csv -o old.svg" "picture groups|a.ply --against b.ply -o old.pdf"
  "picture score|a.ply --model m.h5 -o old.pdf" "picture plot|m.h5 -o old.pdf" "picture modes|m.h5 --mode 1 --frames 2 -o old.gif"
  "propagate|ventricle.ply --image cine.nii.gz --frame 0 -o cine" "study schemes|built-in:kidney --mask mask.nii.gz --schemes anchored --pulls 2 -o tables"
  "model|a.ply b.ply c.ply --optimise -o old.h5.json"
)
# What cannot work on these inputs, or writes nothing: said here, so that a new verb is not forgotten.
elsewhere=("set add" info verify "set info" repair compare bench edit "study bias" "study contours" "study experts")
