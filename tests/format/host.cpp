// A C++ host whose threads open `.skinslide` layers, compose payloads of them, read every frame and drop it all again.
//
//     format_host PLUGIN_FOLDER FILE THREADS SECONDS [--interpreter]
//
// Without Python, or with an interpreter whose lock nobody holds. FILE is read by one thread first, and every other reading
// must come to the same values. The first thread, and every other one after it, reads a file of its own, which nobody else
// keeps open, one that all open and drop, and one that stays open; those between listen to changes of layers and stop
// listening, as stages do.
#include "pxr/pxr.h"
#include <Python.h>

#include "pxr/base/plug/registry.h"
#include "pxr/base/tf/notice.h"
#include "pxr/base/tf/weakBase.h"
#include "pxr/base/vt/value.h"
#include "pxr/usd/ar/resolver.h"
#include "pxr/usd/ar/resolverContext.h"
#include "pxr/usd/pcp/cache.h"
#include "pxr/usd/pcp/layerStack.h"
#include "pxr/usd/pcp/layerStackIdentifier.h"
#include "pxr/usd/pcp/node.h"
#include "pxr/usd/pcp/primIndex.h"
#include "pxr/usd/sdf/layer.h"
#include "pxr/usd/sdf/notice.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

using namespace PXR_NS;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

const char *const pointsPath = "/World/skin.points";

// Which threads open and drop a file that is everybody's, USD orders by locks that ThreadSanitizer does not see, as it is not
// built with it: what one thread fills and another frees would look like a race.
#if defined(__SANITIZE_THREAD__)
constexpr bool allOpenOne = false;
#else
constexpr bool allOpenOne = true;
#endif

struct Run {
    fs::path folder;
    int threads;
    Clock::time_point end;
    std::vector<VtValue> frames; // that every reading must give
    std::atomic<int> opened{0}, different{0};
};

void write(const fs::path &file, const std::string &text) {
    if (!(std::ofstream(file) << text))
        throw std::runtime_error("cannot write " + file.string());
}

fs::path file(const Run &run, int number) {
    return run.folder / ("x" + std::to_string(number) + ".skinslide");
}

fs::path shot(const Run &run, int number) {
    return run.folder / ("shot" + std::to_string(number) + ".usda");
}

// The file that stays open; the one after it is the one that all open and drop.
int kept(const Run &run) {
    return run.threads;
}

void layOut(const Run &run, const std::string &source) {
    write(run.folder / "cache.usda", "#usda 1.0\nover \"World\" {}\n");
    for (int number = 0; number < run.threads + 2; number++) {
        fs::copy_file(source, file(run, number));
        write(shot(run, number), "#usda 1.0\ndef \"World\" (payload = @./" + file(run, number).filename().string() + "@) {}\n");
    }
}

std::vector<VtValue> read(const SdfLayerHandle &layer) {
    SdfPath path(pointsPath);
    std::vector<VtValue> frames;
    for (double time : layer->ListTimeSamplesForPath(path)) {
        VtValue value;
        layer->QueryTimeSample(path, time, &value);
        frames.push_back(value);
    }
    return frames;
}

// The layer that a shot's payload leads to, for as long as the cache that composed it lives.
std::vector<VtValue> readThroughPayload(const fs::path &shot) {
    SdfLayerRefPtr root = SdfLayer::FindOrOpen(shot.string());
    PcpLayerStackIdentifier identifier(root, SdfLayerHandle(), ArGetResolver().GetCurrentContext());
    PcpCache cache(identifier, std::string(), true);
    SdfPath world("/World");
    PcpErrorVector errors;
    cache.RequestPayloads({world}, {});
    for (const PcpNodeRef &node : cache.ComputePrimIndex(world, &errors).GetNodeRange()) {
        for (const SdfLayerRefPtr &layer : node.GetLayerStack()->GetLayers()) {
            if (layer->GetFileExtension() == "skinslide")
                return read(layer);
        }
    }
    return {};
}

// With Python's lock, for as long as this lives, where there is an interpreter: as a host's scripts would read.
class Locked {
  public:
    explicit Locked(bool wanted) : _locked(wanted && Py_IsInitialized()) {
        if (_locked)
            _state = PyGILState_Ensure();
    }
    ~Locked() {
        if (_locked)
            PyGILState_Release(_state);
    }

  private:
    bool _locked;
    PyGILState_STATE _state{};
};

void openFiles(Run *run, int number) {
    const int ways = 6; // each file, as it is and through a payload
    for (int turn = 0; turn < ways || Clock::now() < run->end; turn++) {
        int which = turn % 3 == 0 ? number : turn % 3 == 1 || !allOpenOne ? kept(*run) : kept(*run) + 1;
        Locked locked(turn % 5 < 2);
        std::vector<VtValue> frames =
            turn % 2 ? readThroughPayload(shot(*run, which)) : read(SdfLayer::FindOrOpen(file(*run, which).string()));
        run->opened++, run->different += frames != run->frames;
    }
}

struct Listener : public TfWeakBase {
    explicit Listener(const SdfLayerHandle &layer) {
        key = TfNotice::Register(TfCreateWeakPtr(this), &Listener::hear, layer);
    }
    ~Listener() {
        TfNotice::Revoke(key);
    }
    void hear(const SdfNotice::LayersDidChangeSentPerLayer &) {
        heard++;
    }
    TfNotice::Key key;
    int heard = 0;
};

void listen(Run *run) {
    SdfLayerRefPtr layer = SdfLayer::CreateAnonymous();
    for (int turn = 0; Clock::now() < run->end; turn++) {
        Listener one(layer), another(layer);
        layer->SetComment(std::to_string(turn));
        run->different += one.heard != 1 || another.heard != 1;
    }
}

void work(Run *run) {
    std::vector<std::thread> threads;
    for (int number = 0; number < run->threads; number++)
        threads.emplace_back(number % 2 ? [](Run *each, int) { listen(each); } : openFiles, run, number);
    for (std::thread &thread : threads)
        thread.join();
}

// Takes the folder away again, whatever happens.
struct TemporaryFolder {
    fs::path path = fs::temp_directory_path() / ("format_host." + std::to_string(getpid()));
    TemporaryFolder() {
        fs::create_directory(path);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

int host(char **arguments) {
    TemporaryFolder folder;
    Run run;
    run.folder = folder.path, run.threads = std::stoi(arguments[3]);
    PlugRegistry::GetInstance().RegisterPlugins(fs::absolute(arguments[1]).string());
    layOut(run, arguments[2]);
    run.frames = readThroughPayload(shot(run, 0));
    SdfLayerRefPtr open = SdfLayer::FindOrOpen(file(run, kept(run)).string());
    if (run.frames.size() < 2 || run.frames[0] == run.frames[1])
        throw std::runtime_error(std::string(arguments[2]) + " gives no frames that differ");
    run.end = Clock::now() + std::chrono::milliseconds(static_cast<int>(1000 * std::stod(arguments[4])));
    work(&run);
    std::printf("%d opened, %d came to other values\n", run.opened.load(), run.different.load());
    return run.opened < run.threads || run.different ? 1 : 0;
}

} // namespace

int main(int count, char **arguments) {
    bool interpreter = count == 6 && !std::strcmp(arguments[5], "--interpreter");
    if (count != 5 && !interpreter) {
        std::fprintf(stderr, "usage: %s PLUGIN_FOLDER FILE THREADS SECONDS [--interpreter]\n", arguments[0]);
        return 2;
    }
    if (interpreter) {
        Py_InitializeEx(0);
        PyEval_SaveThread();
    }
    try {
        return host(arguments);
    } catch (const std::exception &bad) {
        std::fprintf(stderr, "%s\n", bad.what());
        return 1;
    }
}
