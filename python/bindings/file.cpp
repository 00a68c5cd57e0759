// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

#include "platform/new_file.h"

namespace cg2raw::python {
namespace {

/// The arguments keep the bytes alive that are read without the GIL.
void write_file(const py::bytes& path, const py::bytes& data, std::optional<int> folder,
                const py::bytes& name)
{
    const std::string shown = path, place = name;
    const std::string_view bytes = data;
    const py::gil_scoped_release release;
    NewFile file = folder ? NewFile(*folder, place, shown) : NewFile(shown);
    if (const std::error_code error = file.write(bytes.data(), bytes.size(), 0))
        throw Error(shown + ": cannot write: " + words_of(error));
    file.publish();
}

} // namespace

void bind_file(py::module_& m)
{
    m.def(
        "write_file", &write_file, "path"_a, "data"_a, "folder"_a = py::none(),
        "name"_a = py::bytes(),
        "Write a file that appears whole or not at all, and is on the disk then.\n\n"
        "path: as the system has it; links are followed. folder: or the descriptor of "
        "an open\none, and a name in it, where a link is replaced (Windows: any, and "
        "the path once\nmore). Raises ValueError.");
}

} // namespace cg2raw::python
