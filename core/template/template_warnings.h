#pragma once

#include <string>
#include <vector>

#include "core/template/template.h"

namespace homolog {

/// Warnings about a template's file, a sentence each that begins with its name: what its reader mended or did
/// not understand (as the space of its coordinates), and faces that look inward. Empty for one that is built in.
std::vector<std::string> template_warnings(const Template& the_template);

}  // namespace homolog
