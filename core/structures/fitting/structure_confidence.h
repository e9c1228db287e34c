#pragma once

#include "core/structures/repair/repair.h"

namespace homolog {

/// The probability that a structure of a label map is right, as its fit tells: that its Dice to the truth is 0.9 or
/// more, and its name the right one. By the doubt, the agreement and how far it lies from where its neighbours say.
double structure_confidence(const FittedStructure& one);

/// The same, and by what else was found.
double structure_confidence(const FittedStructure& one, const StructureSigns& signs, const RepairedStructure& found);

}  // namespace homolog
