// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

#include "cg2raw/frame_statistics.h"

#include <algorithm>
#include <limits>

namespace cg2raw::python {
namespace {

using Doubles = py::array_t<double>;

/// (planes, codes up to the largest that occurs).
py::array_t<std::uint32_t> array_of(const CodeCounts& counts)
{
    std::size_t most = 1;
    for (const auto& count : counts)
        for (std::size_t code = most; code < count.size(); ++code)
            if (count[code])
                most = code + 1;
    py::array_t<std::uint32_t> found({ counts.size(), most });
    for (std::size_t p = 0; p < counts.size(); ++p)
        std::copy_n(counts[p].begin(), most, found.mutable_data(py::ssize_t(p), 0));
    return found;
}

using MaskArray = py::array_t<bool, py::array::c_style | py::array::forcecast>;

py::array_t<std::uint32_t> counts_of(const RawArray& frame, int side,
                                     const std::optional<MaskArray>& excluded,
                                     int threads)
{
    const auto plane = const_plane_of(frame, "frame");
    if (side < 1)
        throw Error("side " + std::to_string(side) + " must be at least 1");
    const std::uint8_t* out = nullptr;
    if (excluded) {
        const auto mask = const_plane_of(*excluded, "mask");
        if (mask.width != plane.width || mask.height != plane.height)
            throw Error("mask is " + std::to_string(mask.width) + " x "
                        + std::to_string(mask.height) + " pixels, the frame "
                        + std::to_string(plane.width) + " x "
                        + std::to_string(plane.height));
        out = reinterpret_cast<const std::uint8_t*>(mask.data);
    }
    CodeCounts counts;
    {
        const py::gil_scoped_release release;
        counts = code_counts(plane, side, out, parallel_threads(threads));
    }
    return array_of(counts);
}

py::array_t<std::uint32_t> look(FrameStatistics& self, int group, const RawArray& frame,
                                int threads)
{
    const auto plane = const_plane_of(frame, "frame");
    CodeCounts counts;
    {
        const py::gil_scoped_release release;
        counts = self.look(group, plane, parallel_threads(threads));
    }
    return array_of(counts);
}

void measure(FrameStatistics& self, int group, const RawArray& frame,
             const std::optional<RawArray>& other, int threads)
{
    const auto plane = const_plane_of(frame, "frame");
    std::optional<Plane<const std::uint16_t>> second;
    if (other)
        second = const_plane_of(*other, "frame");
    const py::gil_scoped_release release;
    self.measure(group, plane, second ? &*second : nullptr, parallel_threads(threads));
}

/// An array of one row for each group, of what @p row says of it.
template <class T, class Row>
py::array_t<T> by_group(const FrameStatistics& self, std::size_t columns,
                        const Row& row)
{
    const auto& groups = self.groups();
    py::array_t<T> found({ groups.size(), columns });
    for (std::size_t g = 0; g < groups.size(); ++g)
        std::copy_n(row(groups[g]), columns, found.mutable_data() + g * columns);
    return found;
}

py::dict plane_of_groups(const FrameStatistics& self, std::size_t p,
                         const std::vector<double>& products)
{
    const PlaneParts& plane = self.planes()[p];
    const PlaneMask& mask = self.masks()[p];
    const auto of = [p](const GroupSums& group) -> const PlaneOfGroup& {
        return group.planes[p];
    };
    py::dict found;
    const auto& groups = self.groups();
    py::array_t<bool> masked({ plane.height(), plane.width() });
    std::fill_n(masked.mutable_data(), masked.size(), false);
    for (const std::uint32_t at : mask.samples)
        masked.mutable_data()[at] = true;
    found["masked"] = masked;
    found["freedom"] = Doubles(part_count, mask.freedom.data());
    Doubles level(py::ssize_t(groups.size())), power(level.size()),
        fourth(level.size());
    py::list levels;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const PlaneOfGroup& one = of(groups[g]);
        // 0 where nothing tells, so that what is divided by it is no number.
        const double pairs = mask.freedom.back() > 0.0 ? groups[g].pairs : 0.0;
        const auto at = py::ssize_t(g);
        level.mutable_at(at) = one.base + one.mean.sum / plane.samples();
        power.mutable_at(at) = one.power / pairs;
        fourth.mutable_at(at) = one.fourth / pairs;
        levels.append(Doubles(py::ssize_t(one.levels.size()), one.levels.data()));
    }
    found["level"] = level;
    found["levels"] = py::tuple(levels);
    found["power"] = power;
    found["fourth"] = fourth;
    std::vector<double> room;
    const auto means
        = [&](const std::vector<double>& sums, double samples, double mean) {
              room.clear();
              for (const double sum : sums)
                  room.push_back(sum / samples - mean);
              return room.data();
          };
    found["rows"] = by_group<double>(
        self, std::size_t(plane.height()), [&](const GroupSums& group) {
            const PlaneSums& sums = of(group).mean;
            return means(sums.rows, plane.width(), sums.sum / plane.samples());
        });
    found["columns"] = by_group<double>(
        self, std::size_t(plane.width()), [&](const GroupSums& group) {
            const PlaneSums& sums = of(group).mean;
            return means(sums.columns, plane.height(), sums.sum / plane.samples());
        });
    found["field"] = by_group<double>(self, field_size, [&](const GroupSums& group) {
                         return of(group).mean.field.data();
                     }).attr("reshape")(-1, field_degree, field_degree);
    found["whole"] = Doubles({ groups.size(), groups.size() }, products.data());
    found["scatter"] = by_group<double>(self, part_count, [&](const GroupSums& group) {
        room.clear();
        for (const double square : of(group).scatter) // a little below 0 by rounding
            room.push_back(group.frames > 1 ? std::max(square, 0.0) : 0.0);
        return room.data();
    });
    found["residuals"]
        = by_group<std::int64_t>(self, statistics_bins, [&](const GroupSums& group) {
              return of(group).residuals.data();
          });
    found["noise"] = by_group<double>(
        self, statistics_blocks * statistics_blocks,
        [&](const GroupSums& group) { return of(group).noise.data(); });
    const std::size_t count = mask.samples.size();
    found["outliers"] = by_group<float>(
        self, count, [&](const GroupSums& group) { return of(group).masked.data(); });
    found["outlier_noise"] = by_group<float>(self, count, [&](const GroupSums& group) {
        room.assign(count, std::numeric_limits<double>::quiet_NaN());
        for (std::size_t i = 0; group.pairs && i < count; ++i)
            room[i] = of(group).masked_noise[i] / group.pairs;
        return room.data();
    });
    return found;
}

py::tuple result(const FrameStatistics& self, int threads)
{
    std::vector<std::vector<double>> products;
    std::array<double, statistics_lags.size()> counts {};
    {
        const py::gil_scoped_release release;
        products = self.products(parallel_threads(threads));
        counts = self.lag_counts();
    }
    py::list planes;
    for (std::size_t p = 0; p < self.planes().size(); ++p)
        planes.append(plane_of_groups(self, p, products[p]));
    std::array<double, statistics_lags.size()> room {};
    const auto lags
        = by_group<double>(self, counts.size(), [&](const GroupSums& group) {
              for (std::size_t i = 0; i < counts.size(); ++i) {
                  const double all = counts[i] * group.pairs;
                  room[i] = all > 0.0 ? group.lags[i] / all : 0.0;
              }
              return room.data();
          });
    const auto groups = py::ssize_t(self.groups().size());
    const py::array_t<std::int64_t> overlaps({ groups, groups },
                                             self.overlaps().data());
    std::size_t most = 0;
    for (const GroupSums& group : self.groups())
        most = std::max(most, group.transients.size());
    py::array_t<std::int64_t> transients(
        { self.groups().size(), most, std::size_t(2) });
    std::fill_n(transients.mutable_data(), transients.size(), 0);
    for (std::size_t g = 0; g < self.groups().size(); ++g)
        for (std::size_t i = 0; i < self.groups()[g].transients.size(); ++i)
            std::copy_n(self.groups()[g].transients[i].begin(), 2,
                        transients.mutable_data(py::ssize_t(g), py::ssize_t(i), 0));
    return py::make_tuple(planes, lags, transients, overlaps);
}

} // namespace

void bind_frame_statistics(py::module_& m)
{
    m.def(
        "code_counts", &counts_of, "frame"_a, "side"_a, "excluded"_a = py::none(),
        "threads"_a = 1,
        "(side * side, codes) how many samples of each plane of the CFA's repeat have "
        "each code,\nup to the largest that occurs. excluded : (H, W) bool, samples "
        "that do not count.");
    py::class_<FrameStatistics>(m, "FrameStatistics",
                                "Sums over groups of frames that repeat each other.")
        .def(py::init([](int height, int width, int side, int groups, int step) {
                 return FrameStatistics({ width, height }, side, groups, step);
             }),
             "height"_a, "width"_a, "side"_a, "groups"_a, "step"_a = 1)
        .def("look", &look, "group"_a, "frame"_a, "threads"_a = 2,
             "(planes, codes) counts of a frame; groups one after the other.")
        .def(
            "exclude",
            [](FrameStatistics& self, const MaskArray& samples) {
                const auto plane = const_plane_of(samples, "mask");
                self.exclude({ reinterpret_cast<const std::uint8_t*>(plane.data),
                               plane.width, plane.height, plane.pitch });
            },
            "samples"_a, "(H, W) bool: samples that are masked.")
        .def(
            "mask",
            [](FrameStatistics& self, int threads) {
                const py::gil_scoped_release release;
                self.mask(parallel_threads(threads));
            },
            "threads"_a = 2, "Find the samples that do not count, after all frames.")
        .def("measure", &measure, "group"_a, "frame"_a, "other"_a = py::none(),
             "threads"_a = 2, "A frame again, or a pair.")
        .def("result", &result, "threads"_a = 2,
             "(list of the planes' arrays, (G, 5) correlations at the lags, (G, F, 2) "
             "transients, (G, G)\nhow many samples are noisy in both of two groups).")
        .def(
            "mean",
            [](const FrameStatistics& self, int group) {
                if (group < 0 || group >= int(self.groups().size()))
                    throw Error("group " + std::to_string(group) + " is none");
                const Size size = self.size();
                FloatArray found({ size.height, size.width });
                self.mean(group, plane_of(found));
                return found;
            },
            "group"_a, "(H, W) float32 DN: the mean image of a group.");
}

} // namespace cg2raw::python
