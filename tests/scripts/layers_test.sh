#!/bin/sh
# Core knows nothing of drawing, drawing nothing of the interface. Debian keeps every header in one folder, so the compiler
# would not notice.
cd "$1" && [ -d core ] && [ -d render ] || exit 1
bad=$(grep -rnE '#include *[<"](GLFW|imgui|epoxy|GL/|EGL/|glm|render/|app/)' core
      grep -rnE '#include *[<"](GLFW|imgui|app/)' render)
# All controls and texts of the program go through widgets.h, where the tests find and operate them.
controls='(Small|Invisible|Arrow)?Button|Checkbox|RadioButton|Selectable|MenuItem|Begin(Menu|Combo|Popup)|Combo|OpenPopup'
controls="$controls|Input[A-Z]|Drag[A-Z]|[VS]Slider|Slider[A-Z]|Color(Edit|Picker|Button)|CollapsingHeader|TreeNode"
bad=$bad$(grep -nE "ImGui::($controls|(Bullet|Label)?Text[A-Z]*)[A-Za-z0-9]*\(|AddText\(" $(find app/editor -name "*.cpp") |
  grep -vE '^app/editor/widgets/widgets')
# A folder of the editor is taken in at a glance.
bad=$bad$(find app/editor -type f | sed 's|/[^/]*$||' | sort | uniq -c | awk '$1 > 25 { print $2 " has " $1 " files; 25 at most" }')
[ -z "$bad" ] || { echo "$bad"; exit 1; }
