// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

namespace cg2raw::python {
namespace {

constexpr py::ssize_t of_float = sizeof(float), of_half = sizeof(std::uint16_t);

bool is_half(const py::array& rgb)
{
    return rgb.dtype().kind() == 'f' && rgb.itemsize() == of_half;
}

/// Whether an RgbView can tell where the pixels lie.
bool can_be_seen(const py::array& rgb)
{
    const auto whole = [&](int axis) { return rgb.strides(axis) % of_float == 0; };
    const auto address = reinterpret_cast<std::uintptr_t>(rgb.data());
    return rgb.strides(2) == of_float && whole(0) && whole(1)
        && address % alignof(float) == 0;
}

void check(const py::array& rgb)
{
    if (rgb.ndim() != 3 || rgb.shape(2) < 3 || rgb.shape(2) > 4)
        throw Error("image must be an array of shape (height, width, 3) or (height, "
                    "width, 4), RGB(A)");
    if (!is_half(rgb) && !rgb.dtype().equal(py::dtype::of<float>()))
        throw Error("image must be float32 or float16, not "
                    + std::string(py::str(rgb.dtype())));
}

} // namespace

Scene::Scene(const py::array& rgb)
    : m_owner(rgb)
    , m_view()
{
    check(rgb);
    m_view.width = int(rgb.shape(1));
    m_view.height = int(rgb.shape(0));
    if (is_half(rgb)) {
        if (!(rgb.flags() & py::array::c_style))
            m_owner = py::array::ensure(rgb, py::array::c_style);
        m_half = static_cast<const std::uint16_t*>(m_owner.data());
        m_view.pixel_stride = m_owner.shape(2);
        m_view.row_stride = m_owner.shape(2) * m_owner.shape(1);
        return;
    }
    if (!can_be_seen(rgb))
        m_owner = py::array::ensure(rgb, py::array::c_style);
    m_view.data = static_cast<const float*>(m_owner.data());
    m_view.pixel_stride = m_owner.strides(1) / of_float;
    m_view.row_stride = m_owner.strides(0) / of_float;
}

SceneRows Scene::rows() const
{
    return [this](int first, int count, std::vector<float>& room) {
        RgbView part = m_view;
        part.height = count;
        if (m_half == nullptr) {
            part.data = m_view.row(first);
            return part;
        }
        room.resize(std::size_t(m_view.row_stride) * std::size_t(count));
        float_from_half(m_half + first * m_view.row_stride, int(room.size()),
                        room.data());
        part.data = room.data();
        return part;
    };
}

} // namespace cg2raw::python
