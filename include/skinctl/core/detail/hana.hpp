// SPDX-License-Identifier: BSD-3-Clause
// Boost.Hana, as skills and activities use it. It uses `I`, which <complex.h> defines, and `Bool`, which
// Xlib.h does.
#pragma once

#pragma push_macro("I")
#pragma push_macro("Bool")
#undef I
#undef Bool
#include <boost/hana/at_key.hpp>
#include <boost/hana/concat.hpp>
#include <boost/hana/core/to.hpp>
#include <boost/hana/filter.hpp>
#include <boost/hana/keys.hpp>
#include <boost/hana/length.hpp>
#include <boost/hana/map.hpp>
#include <boost/hana/pair.hpp>
#include <boost/hana/tuple.hpp>
#include <boost/hana/type.hpp>
#include <boost/hana/union.hpp>
#include <boost/hana/unpack.hpp>
#pragma pop_macro("Bool")
#pragma pop_macro("I")
