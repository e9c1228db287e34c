#!/bin/sh
# Core knows nothing of drawing, drawing nothing of the interface. Debian keeps every header in one folder, so the compiler
# would not notice.
cd "$1" && [ -d core ] && [ -d render ] || exit 1
bad=$(grep -rnE '#include *[<"](GLFW|imgui|epoxy|GL/|EGL/|glm|render/|app/)' core
      grep -rnE '#include *[<"](GLFW|imgui|app/)' render)
[ -z "$bad" ] || { echo "$bad"; exit 1; }
