#pragma once

#include "app/verbs/verb.h"

namespace homolog {

/// Times of drawing and of opening a large volume: the part of `bench` that needs OpenGL and files. If no OpenGL is to
/// be had, the object says so.
Json picture_figures();

}  // namespace homolog
