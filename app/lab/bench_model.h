#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// Times of the model side: aligning, components and measures of 100 shapes on one core, the model of 1,000 shapes on
/// all, with the memory it takes.
Json model_figures();

}  // namespace homolog
