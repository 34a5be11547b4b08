// A C++ host with a whole OpenUSD and no Python, whose threads open a stage that payloads a `.skinslide`, each its own, and
// compare every sample with that of a bake.
//
//     host LAYER.skinslide BAKED.usda THREADS
//
// USD finds the file format by PXR_PLUGINPATH_NAME.
#include "pxr/pxr.h"

#include "pxr/base/gf/vec3f.h"
#include "pxr/base/vt/array.h"
#include "pxr/base/vt/value.h"
#include "pxr/usd/sdf/attributeSpec.h"
#include "pxr/usd/sdf/layer.h"
#include "pxr/usd/sdf/path.h"
#include "pxr/usd/usd/attribute.h"
#include "pxr/usd/usd/prim.h"
#include "pxr/usd/usd/stage.h"

#include <atomic>
#include <cstdio>
#include <cstring>
#include <dlfcn.h>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace PXR_NS;

namespace {

struct Sample {
    SdfPath path;
    double time;
    VtVec3fArray value;
};

std::vector<Sample> samplesOf(const std::string &file) {
    SdfLayerRefPtr layer = SdfLayer::FindOrOpen(file);
    if (!layer)
        throw std::runtime_error("cannot open " + file);
    std::vector<Sample> found;
    layer->Traverse(SdfPath::AbsoluteRootPath(), [&](const SdfPath &path) {
        for (double time : layer->ListTimeSamplesForPath(path)) {
            VtVec3fArray value;
            if (!layer->QueryTimeSample(path, time, &value))
                throw std::runtime_error(path.GetString() + " is of another type than the vectors of a bake");
            found.push_back({path, time, value});
        }
    });
    if (found.empty())
        throw std::runtime_error("there are no samples in " + file);
    return found;
}

bool isSame(const VtVec3fArray &one, const VtVec3fArray &other) {
    return one.size() == other.size() && !std::memcmp(one.cdata(), other.cdata(), one.size() * sizeof(GfVec3f));
}

// How many samples are others; all of them where the stage cannot be opened.
size_t compare(const std::string &live, const std::vector<Sample> &baked) {
    SdfLayerRefPtr root = SdfLayer::CreateAnonymous(".usda");
    if (!root->ImportFromString("#usda 1.0\ndef \"World\" (payload = @" + live + "@</World>) {}\n"))
        return baked.size();
    UsdStageRefPtr stage = UsdStage::Open(root);
    size_t others = 0;
    for (const Sample &sample : baked) {
        VtVec3fArray value;
        UsdAttribute attribute = stage ? stage->GetAttributeAtPath(sample.path) : UsdAttribute();
        others += !attribute || !attribute.Get(&value, sample.time) || !isSame(value, sample.value);
    }
    return others;
}

int host(const std::string &live, const std::string &bake, int count) {
    std::vector<Sample> baked = samplesOf(bake);
    std::atomic<size_t> others{0};
    std::vector<std::thread> threads;
    for (int number = 0; number < count; number++)
        threads.emplace_back([&] { others += compare(live, baked); });
    for (std::thread &thread : threads)
        thread.join();
    bool python = dlsym(RTLD_DEFAULT, "Py_IsInitialized");
    std::printf("OpenUSD %d.%02d: %d threads, %zu samples each, %zu others than in the bake%s\n", PXR_MINOR_VERSION,
                PXR_PATCH_VERSION, count, baked.size(), others.load(), python ? "; Python is there" : "");
    return others ? 1 : 0;
}

} // namespace

int main(int count, char **arguments) {
    if (count != 4) {
        std::fprintf(stderr, "usage: %s LAYER.skinslide BAKED.usda THREADS\n", arguments[0]);
        return 2;
    }
    try {
        return host(arguments[1], arguments[2], std::stoi(arguments[3]));
    } catch (const std::exception &bad) {
        std::fprintf(stderr, "%s\n", bad.what());
        return 1;
    }
}
