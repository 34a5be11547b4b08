#include "liveMesh.h"

#include "environment.h"
#include "fault.h"
#include "names.h"
#include "pythonLock.h"

#include "pxr/base/gf/range3f.h"
#include "pxr/base/tf/diagnostic.h"
#include "pxr/usd/sdf/types.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace skinslide {
namespace {

std::atomic<uint64_t> solveCount{0}, solving{0}, mostAtOnce{0};

// Counts a solve, for as long as it runs.
class Counted {
  public:
    Counted() {
        solveCount++;
        uint64_t now = ++solving, most = mostAtOnce;
        while (now > most && !mostAtOnce.compare_exchange_weak(most, now)) {
        }
    }
    ~Counted() {
        solving--;
    }
};

void check(skinslide_status status, const skinslide_error &error) {
    if (status != SKINSLIDE_OK)
        throw Fault(error.message);
}

const float *floatsOf(const VtVec3fArray &points) {
    return reinterpret_cast<const float *>(points.cdata());
}

float *floatsOf(VtVec3fArray *points) {
    return reinterpret_cast<float *>(points->data());
}

VtValue orBlock(const VtValue &value) {
    return value.IsEmpty() ? VtValue(SdfValueBlock()) : value;
}

// float triples where it can be, so that the type is the one the layer declares.
VtValue asDeclared(const VtValue &value) {
    try {
        return value.IsEmpty() ? VtValue(SdfValueBlock()) : VtValue(positions(value, ""));
    } catch (const Fault &) {
        return value;
    }
}

} // namespace

LiveMesh::LiveMesh(std::shared_ptr<const PatchedMesh> source, const Params &params, std::string layerName)
    : _source(std::move(source)), _lookup(params.lookup), _layerName(std::move(layerName)) {
}

LiveMesh::~LiveMesh() {
    FrameCache::shared().drop(this);
    for (skinslide_workspace *workspace : _idle)
        skinslide_workspace_destroy(workspace);
    skinslide_slider_destroy(_slider);
}

// One message for a time, whatever is asked for there; one in all where the set-up is what fails.
void LiveMesh::say(double time, const std::string &message) {
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (!_said.insert(_problem.empty() ? frameText(time) : "").second)
            return;
    }
    TF_WARN("%s: %s: frame %s: %s", _layerName.c_str(), _source->path.GetText(), frameText(time).c_str(), message.c_str());
}

// ---- The slider ----

skinslide_mesh LiveMesh::nativeMesh() const {
    const Topology &topology = _source->topology;
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    mesh.vertex_count = static_cast<int32_t>(topology.vertexCount);
    mesh.face_count = static_cast<int32_t>(topology.faceCount());
    mesh.index_count = static_cast<int32_t>(topology.faceIndices.size());
    mesh.face_counts = topology.faceCounts.data();
    mesh.face_indices = topology.faceIndices.data();
    mesh.rest_points = floatsOf(_source->rest);
    return mesh;
}

void LiveMesh::build() {
    std::vector<Controls> controls;
    std::vector<skinslide_patch_setup> setups;
    controls.reserve(_source->patches.size());
    try {
        for (const Patch &patch : _source->patches) {
            controls.push_back(patch.controlsAt(Attribute::first, _source->topology));
            setups.push_back(patch.native(controls.back()));
        }
        skinslide_mesh mesh = nativeMesh();
        skinslide_subdivision subdivision = _source->subdivision.native();
        mesh.subdivision = _source->subdivision.any() ? &subdivision : nullptr;
        skinslide_error error = {};
        check(skinslide_slider_create(&mesh, setups.data(), static_cast<int32_t>(setups.size()), &_slider, &error), error);
    } catch (const std::exception &bad) {
        std::lock_guard<std::mutex> lock(_mutex);
        _problem = bad.what();
    }
}

// For good: what keeps one frame from being solved here keeps all of them. Throws Fault.
void LiveMesh::giveUp(const std::string &problem) {
    std::lock_guard<std::mutex> lock(_mutex);
    _problem = problem;
    throw Fault(problem);
}

skinslide_workspace_options LiveMesh::workspaceOptions() {
    skinslide_workspace_options options = SKINSLIDE_WORKSPACE_OPTIONS_DEFAULT;
    auto found = std::find(lookupTokens.begin(), lookupTokens.end(), _lookup);
    options.lookup = static_cast<skinslide_lookup>(found - lookupTokens.begin());
    try {
        options.device = countFromEnvironment("SKINSLIDE_EGL_DEVICE", SKINSLIDE_ANY_DEVICE);
    } catch (const Fault &bad) {
        giveUp(bad.what());
    }
    return options;
}

// Built when the first frame is asked for. Throws Fault where it cannot be.
const skinslide_slider *LiveMesh::slider() {
    std::call_once(_built, [this] { build(); });
    if (!_slider)
        throw Fault(_problem);
    return _slider;
}

skinslide_workspace *LiveMesh::takeWorkspace() {
    const skinslide_slider *slider = this->slider();
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (!_idle.empty()) {
            skinslide_workspace *workspace = _idle.back();
            _idle.pop_back();
            return workspace;
        }
    }
    skinslide_workspace_options options = workspaceOptions();
    skinslide_workspace *workspace = nullptr;
    skinslide_error error = {};
    if (skinslide_workspace_create(slider, &options, &workspace, &error) != SKINSLIDE_OK)
        giveUp(error.message);
    return workspace;
}

void LiveMesh::giveBack(skinslide_workspace *workspace) {
    std::lock_guard<std::mutex> lock(_mutex);
    _idle.push_back(workspace);
}

// ---- Frames ----

VtVec3fArray LiveMesh::cachedPoints(double time) const {
    VtVec3fArray points = positions(_source->points.at(time), "points");
    if (points.empty())
        throw Fault("points has no value");
    if (points.size() != _source->topology.vertexCount)
        throw fault("points has %zu values, but %zu at first; the count must stay the same", points.size(),
                    _source->topology.vertexCount);
    return points;
}

VtVec3fArray LiveMesh::slide(double time) {
    VtVec3fArray cached = cachedPoints(time), slid(cached.size());
    std::vector<Controls> controls;
    std::vector<skinslide_controls> native;
    if (_source->controlsVary()) {
        controls.reserve(_source->patches.size());
        for (const Patch &patch : _source->patches) {
            controls.push_back(patch.controlsAt(time, _source->topology));
            native.push_back(controls.back().native());
        }
    }
    skinslide_workspace *workspace = takeWorkspace();
    skinslide_error error = {};
    skinslide_status status = SKINSLIDE_OK;
    {
        Counted counted;
        status = skinslide_slide(workspace, floatsOf(cached), native.empty() ? nullptr : native.data(), floatsOf(&slid),
                                 nullptr, &error);
    }
    giveBack(workspace);
    check(status, error);
    return slid;
}

Frame LiveMesh::solve(double time) {
    try {
        return {VtValue(slide(time)), true};
    } catch (const std::exception &bad) {
        say(time, std::string(bad.what()) + "; the points are those of the cache");
        return {asDeclared(_source->points.at(time)), false};
    }
}

std::shared_ptr<const Frame> LiveMesh::frame(double time) {
    // A thread that waits for a frame, or solves one, lets others run Python; and one that waited with the lock would keep the
    // one that solves from taking it back.
    PythonReleased released;
    return FrameCache::shared().get(this, time, [&] { return solve(time); });
}

VtValue LiveMesh::points(double time) {
    return frame(time)->points;
}

VtValue LiveMesh::extent(double time) {
    std::shared_ptr<const Frame> found = frame(time);
    if (!found->points.IsHolding<VtVec3fArray>())
        return VtValue(SdfValueBlock());
    GfRange3f range;
    for (const GfVec3f &point : found->points.UncheckedGet<VtVec3fArray>())
        range.UnionWith(point);
    return VtValue(VtVec3fArray{range.GetMin(), range.GetMax()});
}

// The points of a time before and after; false where they could not be solved.
bool LiveMesh::pose(double time, Pose *pose) {
    std::shared_ptr<const Frame> found = frame(time);
    if (!found->slid)
        return false;
    *pose = {cachedPoints(time), found->points.UncheckedGet<VtVec3fArray>()};
    return true;
}

// ---- What follows from points ----

namespace {

skinslide_normals_layout layoutOf(const TfToken &interpolation) {
    if (interpolation == names().vertex || interpolation == names().varying)
        return SKINSLIDE_NORMALS_VERTEX;
    if (interpolation == names().faceVarying)
        return SKINSLIDE_NORMALS_FACE_VARYING;
    if (interpolation == names().uniform)
        return SKINSLIDE_NORMALS_UNIFORM;
    throw fault("interpolation %s is none that normals can have", interpolation.GetText());
}

size_t countFor(skinslide_normals_layout layout, const Topology &topology) {
    return layout == SKINSLIDE_NORMALS_VERTEX         ? topology.vertexCount
           : layout == SKINSLIDE_NORMALS_FACE_VARYING ? topology.faceIndices.size()
                                                      : topology.faceCount();
}

} // namespace

VtValue LiveMesh::normals(double time) {
    VtValue cached;
    try {
        cached = _source->normals.flattened(time);
        // Normals may move over points that do not.
        Pose at;
        if (cached.IsEmpty() || !pose(_source->times.empty() ? Attribute::defaultTime : time, &at))
            return asDeclared(cached);
        VtVec3fArray normals = positions(cached, _source->normals.name());
        skinslide_normals_layout layout = layoutOf(_source->normalsInterpolation);
        checkLength(_source->normals.name(), normals.size(), countFor(layout, _source->topology), "of them to carry");
        skinslide_mesh mesh = nativeMesh();
        skinslide_error error = {};
        check(skinslide_normals(&mesh, floatsOf(at.cached), floatsOf(at.slid), layout, _source->leftHanded, floatsOf(&normals),
                                &error),
              error);
        return VtValue(normals);
    } catch (const std::exception &bad) {
        say(time, "normals left as they are: " + std::string(bad.what()));
        return asDeclared(cached);
    }
}

// The times for a first (2) or second (3) difference: the authored ones next to `time` on either side, with it between them
// for a second difference; at an end of the cache it and those nearest to it.
std::vector<double> LiveMesh::samplesAround(double time, size_t count) const {
    const std::vector<double> &times = _source->pointsTimes;
    std::vector<double> before(times.begin(), std::lower_bound(times.begin(), times.end(), time - sameTime));
    std::vector<double> after(std::upper_bound(times.begin(), times.end(), time + sameTime), times.end());
    if (!before.empty() && !after.empty()) {
        if (count == 2)
            return {before.back(), after.front()};
        return {before.back(), time, after.front()};
    }
    std::vector<double> around{time};
    if (!after.empty())
        around.insert(around.end(), after.begin(), after.begin() + std::min(after.size(), count - 1));
    else
        around.insert(around.begin(), before.end() - std::min(before.size(), count - 1), before.end());
    return around;
}

VtValue LiveMesh::rate(const Rate &rate, double time) {
    VtValue cached = rate.attribute.at(time);
    try {
        std::vector<Pose> poses;
        std::vector<skinslide_sample> samples;
        for (double at : samplesAround(time, rate.sampleCount)) {
            poses.emplace_back();
            if (!pose(at, &poses.back()))
                return asDeclared(cached);
            samples.push_back({sizeof(skinslide_sample), at / _source->timeCodesPerSecond, floatsOf(poses.back().cached),
                               floatsOf(poses.back().slid)});
        }
        VtVec3fArray rates = positions(cached, rate.attribute.name());
        checkLength(rate.attribute.name(), rates.size(), _source->topology.vertexCount, "points");
        if (samples.size() != rate.sampleCount)
            throw Fault("there are too few samples of points");
        auto function = rate.sampleCount == 2 ? skinslide_velocities : skinslide_accelerations;
        skinslide_error error = {};
        check(function(static_cast<int32_t>(rates.size()), samples.data(), floatsOf(&rates), &error), error);
        return VtValue(rates);
    } catch (const std::exception &bad) {
        say(time, rate.attribute.name() + " left as they are: " + bad.what());
        return orBlock(asDeclared(cached));
    }
}

} // namespace skinslide

uint64_t skinslideFormatSolveCount() {
    return skinslide::solveCount;
}

uint64_t skinslideFormatMostAtOnce() {
    return skinslide::mostAtOnce;
}

uint64_t skinslideFormatCacheBytes() {
    return skinslide::FrameCache::shared().bytes();
}
