#pragma once

// Fork Awesome code points (U+F000…), as UTF-8.
namespace homolog::icon {
inline constexpr const char* open = "\xef\x81\xbc";         // folder-open f07c
inline constexpr const char* save = "\xef\x83\x87";         // floppy-o f0c7
inline constexpr const char* undo = "\xef\x83\xa2";         // undo f0e2
inline constexpr const char* redo = "\xef\x80\x9e";         // repeat f01e
inline constexpr const char* keys = "\xef\x84\x9c";         // keyboard-o f11c
inline constexpr const char* enlarge = "\xef\x81\xa5";      // expand f065
inline constexpr const char* shrink = "\xef\x81\xa6";       // compress f066
inline constexpr const char* panel = "\xef\x83\x9b";        // columns f0db
inline constexpr const char* everything = "\xef\x80\x95";   // home f015
inline constexpr const char* pull = "\xef\x89\x9a";         // hand-pointer-o f25a
inline constexpr const char* snap = "\xef\x81\xb6";         // magnet f076
inline constexpr const char* grab = "\xef\x89\x95";         // hand-rock-o f255
inline constexpr const char* slide = "\xef\x83\xac";        // exchange f0ec
inline constexpr const char* relax = "\xef\x81\x83";        // tint f043
inline constexpr const char* place = "\xef\x81\x87";        // arrows f047
inline constexpr const char* landmark = "\xef\x89\xb6";     // map-pin f276
inline constexpr const char* stiffness = "\xef\x87\xbc";    // paint-brush f1fc
inline constexpr const char* confirm = "\xef\x80\xa3";      // lock f023
inline constexpr const char* unlocked = "\xef\x82\x9c";     // unlock f09c
inline constexpr const char* eye = "\xef\x81\xae";          // eye f06e
inline constexpr const char* eye_shut = "\xef\x81\xb0";     // eye-slash f070
inline constexpr const char* ruler = "\xef\x81\xbd";        // arrows-v f07d
inline constexpr const char* contour = "\xef\x81\x80";      // pencil f040
inline constexpr const char* close = "\xef\x80\x8d";        // times f00d
inline constexpr const char* check = "\xef\x80\x8c";        // check f00c
inline constexpr const char* warning = "\xef\x81\xb1";      // exclamation-triangle f071
inline constexpr const char* info = "\xef\x81\x9a";         // info-circle f05a
inline constexpr const char* folder = "\xef\x81\xbb";       // folder f07b
inline constexpr const char* file = "\xef\x80\x96";         // file-o f016
inline constexpr const char* up = "\xef\x81\xa2";           // arrow-up f062
inline constexpr const char* play = "\xef\x81\x8b";         // play f04b
inline constexpr const char* pause = "\xef\x81\x8c";        // pause f04c
inline constexpr const char* camera = "\xef\x80\xb0";       // camera f030
inline constexpr const char* down_angle = "\xef\x84\x87";   // angle-down f107
inline constexpr const char* left_angle = "\xef\x84\x84";   // angle-left f104
inline constexpr const char* right_angle = "\xef\x84\x85";  // angle-right f105
inline constexpr const char* history = "\xef\x87\x9a";      // history f1da
inline constexpr const char* outline = "\xef\x84\x8c";      // circle-o f10c
inline constexpr const char* surface = "\xef\x86\xb2";      // cube f1b2
inline constexpr const char* planes = "\xef\x89\x8d";       // clone f24d
inline constexpr const char* glyphs = "\xef\x8a\xa1";       // braille f2a1
inline constexpr const char* wireframe = "\xef\x83\x8e";    // table f0ce
inline constexpr const char* crosshair = "\xef\x81\x9b";    // crosshairs f05b
inline constexpr const char* letters = "\xef\x80\xb1";      // font f031

// The Models mode has these.
inline constexpr const char* plus = "\xef\x81\xa7";       // plus f067
inline constexpr const char* trash = "\xef\x80\x94";      // trash-o f014
inline constexpr const char* next = "\xef\x81\x91";       // step-forward f051
inline constexpr const char* random = "\xef\x81\xb4";     // random f074
inline constexpr const char* chart = "\xef\x88\x81";      // line-chart f201
inline constexpr const char* note = "\xef\x89\x8a";       // sticky-note-o f24a
inline constexpr const char* half_done = "\xef\x81\x82";  // adjust f042
inline constexpr const char* arrow_up = "\xef\x84\x86";   // angle-up f106
}  // namespace homolog::icon
