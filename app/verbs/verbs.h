#pragma once

#include <array>

#include "app/verbs/verb.h"

namespace homolog {

/// Adds a verb with its name, its help and its options. Once the command line is parsed, `asked` holds the work of the
/// verb that was given. Each is written in a source of this folder or of one within it, which CMake finds by itself.
using AddVerb = void(CLI::App& app, CommandLine& asked);

AddVerb add_demo, add_info, add_replay, add_compare, add_label_map, add_model, add_evaluate, add_mirror, add_phantom,
    add_picture, add_convert, add_study, add_template, add_fit, add_refine, add_snap, add_propagate, add_bench,
    add_measure, add_landmarks, add_observers, add_repair, add_repair_mesh, add_report, add_sample, add_score, add_set,
    add_test, add_tets, add_verify;

/// The verbs, in the order in which `homolog --help` lists them.
inline constexpr std::array all_verbs{
    add_demo,      add_sample,  add_info,     add_replay,      add_compare, add_measure,  add_landmarks, add_observers,
    add_label_map, add_model,   add_evaluate, add_score,       add_test,    add_mirror,   add_phantom,   add_picture,
    add_report,    add_convert, add_tets,     add_repair_mesh, add_study,   add_template, add_set,       add_fit,
    add_repair,    add_refine,  add_snap,     add_propagate,   add_verify,  add_bench};

}  // namespace homolog
