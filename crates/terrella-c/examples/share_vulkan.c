// The Earth in an image that another process sees: this one shares its image's memory as a file descriptor (VK_KHR_external_memory_fd),
// Terrella draws into it, and a second process, here this program once more, has it on a device of its own and writes the picture.
//
//   cc share_vulkan.c $(pkg-config --cflags --libs terrella vulkan) -lm -o share_vulkan && ./share_vulkan shared.png
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <terrella.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

enum { WIDTH = 640, HEIGHT = 360 };
static const VkFormat FORMAT = VK_FORMAT_R8G8B8A8_SRGB;
static const VkImageUsageFlags USAGE = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
static const VkExternalMemoryHandleTypeFlagBits KIND = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;

static void fail(const char *words) {
    fprintf(stderr, "%s\n", words);
    exit(1);
}

static void check(TerrellaStatus status) {
    if (status != TERRELLA_OK) fail(terrella_message());
}

static void vk(VkResult result, const char *what) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "%s: Vulkan answers %d\n", what, result);
        exit(1);
    }
}

typedef struct {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    const char *extensions[65];
    uint32_t extension_count;
    TerrellaVulkanHost host;
} Gpu;

// A device; with what Terrella asks for where it is to draw, and always with shared memory.
static void open_gpu(Gpu *gpu, int draws) {
    VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO, .apiVersion = VK_API_VERSION_1_1};
    VkInstanceCreateInfo instance_info = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, .pApplicationInfo = &application};
    vk(vkCreateInstance(&instance_info, NULL, &gpu->instance), "an instance");
    uint32_t one = 1;
    VkResult found = vkEnumeratePhysicalDevices(gpu->instance, &one, &gpu->physical);
    if ((found != VK_SUCCESS && found != VK_INCOMPLETE) || one == 0) fail("no Vulkan device");
    gpu->host.get_instance_proc_addr = (PFN_vkVoidFunction)vkGetInstanceProcAddr;
    gpu->host.instance = gpu->instance;
    gpu->host.physical_device = gpu->physical;
    gpu->host.api_version = VK_API_VERSION_1_1;
    for (size_t n = 0; draws && n < 64; n++) {
        check(terrella_vulkan_extension(&gpu->host, n, &gpu->extensions[n]));
        if (!gpu->extensions[n]) break;
        gpu->extension_count = n + 1;
    }
    gpu->extensions[gpu->extension_count++] = VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME;
    VkPhysicalDeviceFeatures features;
    vkGetPhysicalDeviceFeatures(gpu->physical, &features);
    float priority = 1;
    VkDeviceQueueCreateInfo queue_info = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, .queueCount = 1, .pQueuePriorities = &priority};
    VkDeviceCreateInfo device_info = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue_info,
                                      .enabledExtensionCount = gpu->extension_count, .ppEnabledExtensionNames = gpu->extensions,
                                      .pEnabledFeatures = &features};
    vk(vkCreateDevice(gpu->physical, &device_info, NULL, &gpu->device), "a device with VK_KHR_external_memory_fd");
    vkGetDeviceQueue(gpu->device, 0, 0, &gpu->queue);
    gpu->host.device = gpu->device;
    gpu->host.device_extensions = gpu->extensions;
    gpu->host.device_extension_count = gpu->extension_count;
    // Whether images of this kind can be shared so at all.
    VkPhysicalDeviceExternalImageFormatInfo external = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_IMAGE_FORMAT_INFO, .handleType = KIND};
    VkPhysicalDeviceImageFormatInfo2 asked = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_IMAGE_FORMAT_INFO_2, &external, .format = FORMAT,
                                              .type = VK_IMAGE_TYPE_2D, .tiling = VK_IMAGE_TILING_OPTIMAL, .usage = USAGE};
    VkExternalImageFormatProperties shares = {.sType = VK_STRUCTURE_TYPE_EXTERNAL_IMAGE_FORMAT_PROPERTIES};
    VkImageFormatProperties2 answer = {.sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_PROPERTIES_2, .pNext = &shares};
    vk(vkGetPhysicalDeviceImageFormatProperties2(gpu->physical, &asked, &answer), "images that are shared as file descriptors");
    VkExternalMemoryFeatureFlags wanted = VK_EXTERNAL_MEMORY_FEATURE_EXPORTABLE_BIT | VK_EXTERNAL_MEMORY_FEATURE_IMPORTABLE_BIT;
    if ((shares.externalMemoryProperties.externalMemoryFeatures & wanted) != wanted)
        fail("this driver shares no such images between processes");
}

static VkDeviceMemory memory(Gpu *gpu, VkMemoryRequirements needed, VkMemoryPropertyFlags wanted, const void *more) {
    VkPhysicalDeviceMemoryProperties types;
    vkGetPhysicalDeviceMemoryProperties(gpu->physical, &types);
    for (uint32_t i = 0; i < types.memoryTypeCount; i++) {
        if ((needed.memoryTypeBits >> i & 1) && (types.memoryTypes[i].propertyFlags & wanted) == wanted) {
            VkMemoryAllocateInfo info = {VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, more, .allocationSize = needed.size, .memoryTypeIndex = i};
            VkDeviceMemory got;
            vk(vkAllocateMemory(gpu->device, &info, NULL, &got), "memory");
            return got;
        }
    }
    fail("no memory of that kind");
    return VK_NULL_HANDLE;
}

// The image, with memory that is shared: exported, or imported from `fd`, which then is Vulkan's.
static VkImage shared_image(Gpu *gpu, int fd, VkDeviceMemory *its_memory) {
    VkExternalMemoryImageCreateInfo external = {VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO, .handleTypes = KIND};
    VkImageCreateInfo info = {VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, &external, .imageType = VK_IMAGE_TYPE_2D, .format = FORMAT,
                              .extent = {WIDTH, HEIGHT, 1}, .mipLevels = 1, .arrayLayers = 1, .samples = VK_SAMPLE_COUNT_1_BIT, .usage = USAGE};
    VkImage image;
    vk(vkCreateImage(gpu->device, &info, NULL, &image), "an image");
    VkMemoryRequirements needed;
    vkGetImageMemoryRequirements(gpu->device, image, &needed);
    VkMemoryDedicatedAllocateInfo alone = {VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO, .image = image};
    VkExportMemoryAllocateInfo exports = {VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO, &alone, KIND};
    VkImportMemoryFdInfoKHR imports = {VK_STRUCTURE_TYPE_IMPORT_MEMORY_FD_INFO_KHR, &alone, KIND, fd};
    *its_memory = memory(gpu, needed, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, fd < 0 ? (const void *)&exports : (const void *)&imports);
    vk(vkBindImageMemory(gpu->device, image, *its_memory, 0), "an image in shared memory");
    return image;
}

static VkCommandBuffer begin(Gpu *gpu, VkCommandPool *pool) {
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    vk(vkCreateCommandPool(gpu->device, &pool_info, NULL, pool), "commands");
    VkCommandBufferAllocateInfo info = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = *pool, .commandBufferCount = 1};
    VkCommandBuffer commands;
    vk(vkAllocateCommandBuffers(gpu->device, &info, &commands), "commands");
    VkCommandBufferBeginInfo begins = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    vk(vkBeginCommandBuffer(commands, &begins), "commands");
    return commands;
}

// The image goes to another owner, or comes from it: both sides name the same layouts.
static void hand_over(VkCommandBuffer commands, VkImage image, uint32_t from, uint32_t to) {
    VkImageMemoryBarrier barrier = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER, .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT, .oldLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                    .newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, .srcQueueFamilyIndex = from, .dstQueueFamilyIndex = to,
                                    .image = image, .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

static void finish(Gpu *gpu, VkCommandBuffer commands, VkCommandPool pool) {
    vk(vkEndCommandBuffer(commands), "commands");
    VkSubmitInfo submit = {VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    vk(vkQueueSubmit(gpu->queue, 1, &submit, VK_NULL_HANDLE), "a submission");
    // Where the driver shares semaphores they can be waited for instead; the end of the work is always enough.
    vk(vkQueueWaitIdle(gpu->queue), "the queue");
    vkDestroyCommandPool(gpu->device, pool, NULL);
}

static void close_gpu(Gpu *gpu, VkImage image, VkDeviceMemory image_memory) {
    vkDestroyImage(gpu->device, image, NULL);
    vkFreeMemory(gpu->device, image_memory, NULL);
    vkDestroyDevice(gpu->device, NULL);
    vkDestroyInstance(gpu->instance, NULL);
}

// The second process: the image is there, drawn; it is copied out to be looked at.
static int look(int fd, const char *png) {
    Gpu gpu = {0};
    open_gpu(&gpu, 0);
    VkDeviceMemory image_memory;
    VkImage image = shared_image(&gpu, fd, &image_memory);
    VkBufferCreateInfo info = {VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 4 * WIDTH * HEIGHT, .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VkBuffer buffer;
    vk(vkCreateBuffer(gpu.device, &info, NULL, &buffer), "a buffer");
    VkMemoryRequirements needed;
    vkGetBufferMemoryRequirements(gpu.device, buffer, &needed);
    VkDeviceMemory buffer_memory = memory(&gpu, needed, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, NULL);
    vk(vkBindBufferMemory(gpu.device, buffer, buffer_memory, 0), "a buffer");
    VkCommandPool pool;
    VkCommandBuffer commands = begin(&gpu, &pool);
    hand_over(commands, image, VK_QUEUE_FAMILY_EXTERNAL, 0);
    VkBufferImageCopy copy = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = {WIDTH, HEIGHT, 1}};
    vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &copy);
    finish(&gpu, commands, pool);
    void *mapped;
    vk(vkMapMemory(gpu.device, buffer_memory, 0, VK_WHOLE_SIZE, 0, &mapped), "the picture");
    check(terrella_write_png(png, mapped, WIDTH, HEIGHT));
    vkDestroyBuffer(gpu.device, buffer, NULL);
    vkFreeMemory(gpu.device, buffer_memory, NULL);
    close_gpu(&gpu, image, image_memory);
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 4 && !strcmp(argv[1], "--look")) return look(atoi(argv[2]), argv[3]);
    Gpu gpu = {0};
    open_gpu(&gpu, 1);
    VkDeviceMemory image_memory;
    VkImage image = shared_image(&gpu, -1, &image_memory);
    TerrellaOptions options;
    check(terrella_options_default(&options));
    TerrellaVulkanEarth *earth;
    check(terrella_vulkan_earth_new(&gpu.host, &options, FORMAT, &earth));
    TerrellaTime time;
    check(terrella_time_utc("2018-06-21T16:00:00Z", &time));
    TerrellaCamera camera;
    check(terrella_camera_geodetic(13, 14, 5e6, 270, -60, 45, (double)WIDTH / HEIGHT, &camera));
    TerrellaVulkanImage target = {.image = (uint64_t)image, .width = WIDTH, .height = HEIGHT, .layout = TERRELLA_LAYOUT_TRANSFER};
    check(terrella_vulkan_draw(earth, &camera, time, 30, &target, NULL));
    VkCommandPool pool;
    VkCommandBuffer commands = begin(&gpu, &pool);
    hand_over(commands, image, 0, VK_QUEUE_FAMILY_EXTERNAL);
    finish(&gpu, commands, pool);

    PFN_vkGetMemoryFdKHR get_fd = (PFN_vkGetMemoryFdKHR)vkGetDeviceProcAddr(gpu.device, "vkGetMemoryFdKHR");
    VkMemoryGetFdInfoKHR info = {VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR, .memory = image_memory, .handleType = KIND};
    int fd;
    vk(get_fd(gpu.device, &info, &fd), "a file descriptor of the memory");
    // An inherited descriptor here; programs that are started apart send it over a Unix socket (SCM_RIGHTS).
    int kept = dup(fd);
    close(fd);
    char number[16];
    snprintf(number, sizeof number, "%d", kept);
    pid_t child = fork();
    if (child == 0) {
        execl(argv[0], argv[0], "--look", number, argc > 1 ? argv[1] : "shared.png", (char *)NULL);
        _exit(127);
    }
    close(kept);
    int status = -1;
    if (child < 0 || waitpid(child, &status, 0) < 0 || status != 0) fail("the second process failed");
    check(terrella_vulkan_earth_free(earth));
    close_gpu(&gpu, image, image_memory);
    return 0;
}
