// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Constructors whose failure Python hears of, whatever fails, and what pickle
/// calls them with.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

namespace cg2raw::python {

/// Gives a class a constructor that returns what @p make does. As py::init(), but for
/// the memory in which pybind11 enters a new object: it takes that where no exception
/// may pass, or, of a holder, deletes the object twice; here it is asked for in the
/// call.
template <class T, class... Args, class... Extra>
void def_constructor(pybind11::class_<T>& bound, T (*make)(Args...),
                     const Extra&... extra)
{
    const auto construct
        = [make](pybind11::detail::value_and_holder& place, Args... args) {
              auto made = std::make_unique<T>(make(std::forward<Args>(args)...));
              place.value_ptr() = made.get();
              try {
                  place.type->init_instance(place.inst, &made); // takes it
              } catch (...) {
                  place.value_ptr() = nullptr; // made is still its owner
                  throw;
              }
          };
    bound.def("__init__", construct, pybind11::detail::is_new_style_constructor(),
              extra...);
}

/// What pickle and copy make an object anew of: its class, and arguments of that.
/// pybind11's functions have no name by which pickle would find them.
template <class T, class... Args> pybind11::tuple remade_as(const Args&... args)
{
    return pybind11::make_tuple(pybind11::type::of<T>(), pybind11::make_tuple(args...));
}

} // namespace cg2raw::python
