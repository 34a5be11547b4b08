#include "liveMesh.h"

#include "environment.h"
#include "fault.h"
#include "names.h"
#include "pythonLock.h"

#include "pxr/base/tf/diagnostic.h"
#include "pxr/base/tf/stringUtils.h"
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

// As sentences write it; "default" where it is the default time.
std::string frameText(double time) {
    char text[32] = "default";
    if (!std::isnan(time))
        skinslide_stage_frame_text(time, text);
    return text;
}

// The cache's own value, indices applied: float triples where it can be, so that the type is the one the layer declares.
VtValue asDeclared(const Record &record) {
    if (record.value().IsEmpty())
        return VtValue(SdfValueBlock());
    VtVec3fArray out(static_cast<size_t>(skinslide_value_length(record)));
    return skinslide_value_positions(record, floatsOf(&out), nullptr) == SKINSLIDE_OK ? VtValue(out) : record.value();
}

} // namespace

LiveMesh::LiveMesh(std::shared_ptr<const PatchedMesh> mesh, skinslide_lookup lookup, std::string layerName)
    : _mesh(std::move(mesh)), _lookup(lookup), _layerName(std::move(layerName)) {
}

LiveMesh::~LiveMesh() {
    FrameCache::shared().drop(this);
    _idle.clear();
    skinslide_slider_destroy(_slider);
}

// One message for a time, whatever is asked for there; one in all where the set-up is what fails.
void LiveMesh::warnOfFailure(double time, const std::string &message) {
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (!_warned.insert(_problem.empty() ? frameText(time) : "").second)
            return;
    }
    warn(time, message);
}

// One message in all.
void LiveMesh::warnOnce(const std::string &what, double time, const std::string &message) {
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (!_warned.insert(what).second)
            return;
    }
    warn(time, message);
}

void LiveMesh::warn(double time, const std::string &message) const {
    TF_WARN("%s: %s: frame %s: %s", _layerName.c_str(), _mesh->path.GetText(), frameText(time).c_str(), message.c_str());
}

// Points that pass as they are.
void LiveMesh::warnOfFaults(double time, const VtVec3fArray &cached) {
    int32_t passed = 0;
    skinslide_error warning;
    if (skinslide_slider_check_points(_slider, floatsOf(cached), &passed, &warning, nullptr) == SKINSLIDE_OK && passed)
        warnOnce("points", time, warning.message);
}

// What is degraded: of each kind the first frame at which a patch is.
void LiveMesh::warnOfDegraded(double time, const skinslide_workspace *workspace) {
    skinslide_error warning;
    for (int32_t patch = 0; skinslide_workspace_degraded(workspace, patch, 0, nullptr) >= 0; patch++)
        for (int32_t kind = 0, count = 0; (count = skinslide_workspace_degraded(workspace, patch, kind, &warning)) >= 0; kind++)
            if (count > 0)
                warnOnce(TfStringPrintf("patch %d %d", patch, kind), time, warning.message);
}

void LiveMesh::warnOfFaults(const Derived &derived, double time) {
    int32_t faults = 0;
    skinslide_error warning;
    if (skinslide_stage_derived_faults(_mesh->derivation.get(), derived.output, derived.cached.at(time), &faults, &warning,
                                       nullptr) == SKINSLIDE_OK &&
        faults)
        warnOnce(derived.output->name, time, warning.message);
}

// ---- The slider ----

// Shows a weld every pose of the cache, but for those that cannot be slid.
void LiveMesh::showPoses(skinslide_weld *weld) const {
    std::vector<double> times = _mesh->points.attribute().times();
    if (times.empty())
        times.push_back(Attribute::defaultTime);
    for (double time : times) {
        try {
            VtVec3fArray points = cachedPoints(_mesh->points.at(time));
            skinslide_weld_show(weld, time, floatsOf(points), nullptr);
        } catch (const Fault &) {
            continue; // which is said when it is to be slid
        }
    }
}

// Which points are one, whatever frames are asked for; empty where none is one with another. Throws Fault.
std::vector<int32_t> LiveMesh::weld(const std::vector<skinslide_patch_setup> &setups) const {
    skinslide_weld *made = nullptr;
    call(skinslide_stage_mesh_weld, _mesh->mesh.get(), setups.data(), static_cast<int32_t>(setups.size()), &made);
    std::unique_ptr<skinslide_weld, Destroyer<skinslide_weld, skinslide_weld_destroy>> weld(made);
    if (!skinslide_weld_wants_poses(made))
        return {};
    skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
    call(skinslide_stage_mesh_get, _mesh->mesh.get(), &mesh);
    std::vector<int32_t> vertices(static_cast<size_t>(mesh.vertex_count));
    showPoses(made);
    call(skinslide_weld_get, made, vertices.data(), nullptr);
    return vertices;
}

void LiveMesh::build() {
    std::vector<skinslide_patch_setup> setups;
    try {
        for (const Patch &patch : _mesh->patches)
            setups.push_back(patch.setup());
        skinslide_mesh mesh = SKINSLIDE_MESH_DEFAULT;
        call(skinslide_stage_mesh_get, _mesh->mesh.get(), &mesh);
        std::vector<int32_t> weld = this->weld(setups);
        mesh.weld = weld.empty() ? nullptr : weld.data();
        call(skinslide_slider_create, &mesh, setups.data(), static_cast<int32_t>(setups.size()), &_slider);
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
    options.lookup = _lookup;
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

LiveMesh::Work LiveMesh::takeWork() {
    const skinslide_slider *slider = this->slider();
    {
        std::lock_guard<std::mutex> lock(_mutex);
        if (!_problem.empty())
            throw Fault(_problem);
        if (!_idle.empty()) {
            Work work = std::move(_idle.back());
            _idle.pop_back();
            return work;
        }
    }
    skinslide_workspace_options options = workspaceOptions();
    skinslide_workspace *workspace = nullptr;
    skinslide_error error = {};
    if (skinslide_workspace_create(slider, &options, &workspace, &error) != SKINSLIDE_OK)
        giveUp(error.message);
    Work work;
    work.workspace.reset(workspace);
    for (const Patch &patch : _mesh->patches)
        work.controls.push_back(_mesh->controlsVary() ? patch.frames() : nullptr);
    return work;
}

void LiveMesh::giveBack(Work work) {
    std::lock_guard<std::mutex> lock(_mutex);
    _idle.push_back(std::move(work));
}

// ---- Frames ----

// Floats, converted where they are none: otherwise they are the layer's own, and cost no memory.
VtVec3fArray LiveMesh::cachedPoints(const Record &record) const {
    call(skinslide_stage_points, _mesh->mesh.get(), record, nullptr);
    if (record.value().IsHolding<VtVec3fArray>())
        return record.value().UncheckedGet<VtVec3fArray>();
    VtVec3fArray points(record.value().GetArraySize());
    call(skinslide_stage_points, _mesh->mesh.get(), record, floatsOf(&points));
    return points;
}

// Of each patch; none where none varies.
std::vector<skinslide_controls> LiveMesh::controlsAt(double time, const Work &work) const {
    std::vector<skinslide_controls> controls;
    for (size_t i = 0; _mesh->controlsVary() && i < _mesh->patches.size(); i++) {
        const Patch &patch = _mesh->patches[i];
        try {
            controls.push_back(patch.controlsAt(time, work.controls[i].get()));
        } catch (const Fault &bad) {
            throw Fault("patch " + patch.name() + ": " + bad.what());
        }
    }
    return controls;
}

Frame LiveMesh::slide(double time) {
    Record record = _mesh->points.at(time);
    VtVec3fArray cached = cachedPoints(record), slid(cached.size()), turns(_mesh->carries() ? cached.size() : 0);
    Work work = takeWork();
    try {
        std::vector<skinslide_controls> controls = controlsAt(time, work);
        Counted counted;
        call(skinslide_slide, work.workspace.get(), floatsOf(cached), controls.empty() ? nullptr : controls.data(),
             floatsOf(&slid), nullptr);
        if (!turns.empty())
            call(skinslide_workspace_turns, work.workspace.get(), floatsOf(cached), floatsOf(&turns));
    } catch (const Fault &) {
        giveBack(std::move(work));
        throw;
    }
    warnOfDegraded(time, work.workspace.get());
    giveBack(std::move(work));
    warnOfFaults(time, cached);
    int arrays = record.value().IsHolding<VtVec3fArray>() ? 1 : 2;
    return {VtValue(slid), cached, turns, (arrays * slid.size() + turns.size()) * sizeof(GfVec3f)};
}

Frame LiveMesh::solve(double time) {
    try {
        return slide(time);
    } catch (const std::exception &bad) {
        warnOfFailure(time, std::string(bad.what()) + "; the points are those of the cache");
        VtValue points = asDeclared(_mesh->points.at(time));
        return {points, {}, {}, points.IsArrayValued() ? points.GetArraySize() * sizeof(GfVec3f) : 0};
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
    const auto &points = found->points.UncheckedGet<VtVec3fArray>();
    VtVec3fArray extent(2);
    call(skinslide_extent, floatsOf(points), static_cast<int32_t>(points.size()), floatsOf(&extent));
    return VtValue::Take(extent);
}

// ---- What follows from points ----

VtValue LiveMesh::derived(const Derived &derived, double time) {
    const skinslide_stage_output *output = derived.output;
    double times[3];
    int32_t count = skinslide_stage_derived_times(_mesh->derivation.get(), output, time, times);
    std::vector<std::shared_ptr<const Frame>> frames;
    std::vector<skinslide_stage_pose> poses;
    for (int32_t i = 0; i < count; i++) {
        // Normals may move over points that do not.
        frames.push_back(frame(_mesh->times.empty() ? Attribute::defaultTime : times[i]));
        if (frames.back()->cached.empty())
            return asDeclared(derived.cached.at(time));
        poses.push_back({sizeof(skinslide_stage_pose), times[i], floatsOf(frames.back()->cached),
                         floatsOf(frames.back()->points.UncheckedGet<VtVec3fArray>()), floatsOf(frames.back()->turns)});
    }
    try {
        VtVec3fArray floats(output->is_double ? 0 : static_cast<size_t>(output->count));
        VtVec3dArray doubles(output->is_double ? static_cast<size_t>(output->count) : 0);
        void *out = output->is_double ? static_cast<void *>(doubles.data()) : floats.data();
        call(skinslide_stage_derived_value, _mesh->derivation.get(), output, derived.cached.at(time), poses.data(), count, out);
        warnOfFaults(derived, time);
        return output->is_double ? VtValue(doubles) : VtValue(floats);
    } catch (const std::exception &bad) {
        warnOfFailure(time, std::string(output->name) + " cannot be recomputed, so they are blocked here: " + bad.what());
        return VtValue(SdfValueBlock());
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
