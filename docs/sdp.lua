-- SpiNNaker's datagrams (SDP, SCP) over UDP with this project's commands, for Wireshark and tshark.
--
--   wireshark -X lua_script:docs/sdp.lua core-0.pcap
--   tshark -X lua_script:docs/sdp.lua -r core-0.pcap -T fields -e spinnaker.command -e spinnaker.pixels.unit
--
-- A datagram is known by its form, whatever its port. Where another protocol claims the port, give it to this one:
-- `-d udp.port==PORT,spinnaker`, as `cargo xtask trace` says. The layout is that of the crate `wire`, which documents it.
-- (`sdp` alone is what Wireshark calls the Session Description Protocol.)

local spinnaker = Proto("spinnaker", "SpiNNaker Datagram Protocol")

local COMMANDS = {
    [0x0101] = "HELLO",
    [0x0102] = "PIXELS",
    [0x0103] = "FAREWELL",
    [0x0104] = "FAULT",
    [0x0201] = "LEASE",
    [0x0202] = "STOP",
}

local HEADER = 26
local DEFAULT_PORT = 17893
local HOST = 0xff
local CORE_PORT = 1
local CORES_PER_CHIP = 17
local PIXEL = 15 -- bytes of sums

local f = {
    padding = ProtoField.uint16("spinnaker.padding", "Padding", base.HEX),
    flags = ProtoField.uint8("spinnaker.flags", "Flags", base.HEX),
    tag = ProtoField.uint8("spinnaker.tag", "Tag", base.DEC),
    dest_port_cpu = ProtoField.uint8("spinnaker.dest_port_cpu", "Destination port and processor", base.HEX),
    dest_port = ProtoField.uint8("spinnaker.dest_port", "Port", base.DEC, nil, 0xe0),
    dest_cpu = ProtoField.uint8("spinnaker.dest_cpu", "Processor", base.DEC, nil, 0x1f),
    srce_port_cpu = ProtoField.uint8("spinnaker.srce_port_cpu", "Source port and processor", base.HEX),
    srce_port = ProtoField.uint8("spinnaker.srce_port", "Port", base.DEC, nil, 0xe0),
    srce_cpu = ProtoField.uint8("spinnaker.srce_cpu", "Processor", base.DEC, nil, 0x1f),
    dest_y = ProtoField.uint8("spinnaker.dest_y", "Destination chip y", base.DEC),
    dest_x = ProtoField.uint8("spinnaker.dest_x", "Destination chip x", base.DEC),
    srce_y = ProtoField.uint8("spinnaker.srce_y", "Source chip y", base.DEC),
    srce_x = ProtoField.uint8("spinnaker.srce_x", "Source chip x", base.DEC),
    core = ProtoField.uint32("spinnaker.core", "Core", base.DEC),
    cmd_rc = ProtoField.uint16("spinnaker.cmd_rc", "Command", base.HEX, COMMANDS),
    command = ProtoField.string("spinnaker.command", "Command's name"),
    seq = ProtoField.uint16("spinnaker.seq", "Sequence number", base.DEC),
    arg1 = ProtoField.uint32("spinnaker.arg1", "Argument 1 (session)", base.HEX),
    arg2 = ProtoField.uint32("spinnaker.arg2", "Argument 2", base.DEC),
    arg3 = ProtoField.uint32("spinnaker.arg3", "Argument 3", base.DEC),
    data = ProtoField.bytes("spinnaker.data", "Data"),

    version = ProtoField.uint32("spinnaker.hello.version", "Version of the wire", base.DEC),
    scene = ProtoField.uint32("spinnaker.scene", "Scene", base.HEX),
    board = ProtoField.stringz("spinnaker.hello.board", "Board"),
    profile = ProtoField.stringz("spinnaker.hello.profile", "Arithmetic profile"),

    unit = ProtoField.uint32("spinnaker.pixels.unit", "Unit", base.DEC),
    epoch = ProtoField.uint16("spinnaker.pixels.epoch", "Camera epoch", base.DEC),
    samples = ProtoField.uint16("spinnaker.pixels.samples", "Samples a pixel", base.DEC),
    pixels = ProtoField.uint8("spinnaker.pixels.count", "Pixels", base.DEC),
    ticks = ProtoField.uint32("spinnaker.pixels.ticks", "24 MHz ticks", base.DEC),
    rays = ProtoField.uint32("spinnaker.pixels.rays", "Rays", base.DEC),
    sums = ProtoField.bytes("spinnaker.pixels.sums", "Sums"),

    rejected = ProtoField.uint32("spinnaker.farewell.rejected", "Packets rejected", base.DEC),
    stack_used = ProtoField.uint32("spinnaker.farewell.stack_used", "Most stack used", base.DEC),
    stack_size = ProtoField.uint32("spinnaker.farewell.stack_size", "Size of the stack", base.DEC),

    address = ProtoField.uint32("spinnaker.fault.address", "Address of the instruction", base.HEX),
    reason = ProtoField.string("spinnaker.fault.reason", "Reason"),

    first = ProtoField.uint32("spinnaker.lease.first", "First unit", base.DEC),
    count = ProtoField.uint32("spinnaker.lease.count", "Units", base.DEC),
}
spinnaker.fields = f

-- What each command makes of arguments 2 and 3 (at 18 and 22) and of the data (from 26); returns words for the packet list.
-- Tests of the crate `wire` compare names and places with its own.
local BODIES = {
    HELLO = function(tree, packet)
        tree:add_le(f.version, packet(18, 4))
        tree:add_le(f.scene, packet(22, 4))
        tree:add(f.board, packet(26, 12))
        tree:add(f.profile, packet(38, 12))
        return packet(26, 12):stringz() .. ", " .. packet(38, 12):stringz()
    end,
    PIXELS = function(tree, packet)
        tree:add_le(f.unit, packet(18, 4))
        tree:add_le(f.epoch, packet(22, 2))
        tree:add_le(f.samples, packet(24, 2))
        tree:add_le(f.scene, packet(26, 4))
        tree:add_le(f.ticks, packet(30, 4))
        tree:add_le(f.rays, packet(34, 4))
        tree:add(f.sums, packet(38))
        tree:add(f.pixels, math.floor((packet:len() - 38) / PIXEL)):set_generated()
        return "unit " .. packet(18, 4):le_uint()
    end,
    FAREWELL = function(tree, packet)
        tree:add_le(f.rejected, packet(18, 4))
        tree:add_le(f.stack_used, packet(22, 4))
        tree:add_le(f.stack_size, packet(26, 4))
        return packet(12, 2):le_uint() .. " packets of pixels"
    end,
    FAULT = function(tree, packet)
        if packet(22, 4):le_uint() == 1 then
            tree:add_le(f.address, packet(18, 4))
        end
        if packet:len() == HEADER then
            return ""
        end
        tree:add(f.reason, packet(HEADER))
        return packet(HEADER):string()
    end,
    LEASE = function(tree, packet)
        tree:add_le(f.first, packet(18, 4))
        tree:add_le(f.count, packet(22, 4))
        local first = packet(18, 4):le_uint()
        return "units " .. first .. " to " .. first + packet(22, 4):le_uint() - 1
    end,
    STOP = function()
        return ""
    end,
}

-- The fewest bytes that a packet of each command has.
local LEAST = { HELLO = 50, PIXELS = 53, FAREWELL = 30, FAULT = 26, LEASE = 26, STOP = 26 }

-- The number of the core at one end, where the other is the host.
local function core_of(packet)
    local dest, srce = packet(4, 1):uint(), packet(5, 1):uint()
    local port_cpu, chip
    if dest == HOST then
        port_cpu, chip = srce, packet(8, 2)
    elseif srce == HOST then
        port_cpu, chip = dest, packet(6, 2)
    else
        return nil
    end
    local port, cpu = math.floor(port_cpu / 32), port_cpu % 32
    if port ~= CORE_PORT or cpu < 1 or cpu > CORES_PER_CHIP then
        return nil
    end
    return chip:uint() * CORES_PER_CHIP + cpu - 1 -- row, then column
end

local function is_ours(packet)
    return packet:len() >= HEADER
        and packet(0, 2):uint() == 0
        and COMMANDS[packet(10, 2):le_uint()] ~= nil
        and core_of(packet) ~= nil
end

local function add_headers(tree, packet)
    tree:add(f.padding, packet(0, 2))
    tree:add(f.flags, packet(2, 1))
    tree:add(f.tag, packet(3, 1))
    local dest = tree:add(f.dest_port_cpu, packet(4, 1))
    dest:add(f.dest_port, packet(4, 1))
    dest:add(f.dest_cpu, packet(4, 1))
    local srce = tree:add(f.srce_port_cpu, packet(5, 1))
    srce:add(f.srce_port, packet(5, 1))
    srce:add(f.srce_cpu, packet(5, 1))
    tree:add(f.dest_y, packet(6, 1))
    tree:add(f.dest_x, packet(7, 1))
    tree:add(f.srce_y, packet(8, 1))
    tree:add(f.srce_x, packet(9, 1))
    tree:add_le(f.cmd_rc, packet(10, 2))
    tree:add_le(f.seq, packet(12, 2))
    tree:add_le(f.arg1, packet(14, 4))
    tree:add_le(f.arg2, packet(18, 4))
    tree:add_le(f.arg3, packet(22, 4))
    if packet:len() > HEADER then
        tree:add(f.data, packet(HEADER))
    end
end

function spinnaker.dissector(packet, info, root)
    if not is_ours(packet) then
        return 0
    end
    local command, core = COMMANDS[packet(10, 2):le_uint()], core_of(packet)
    local tree = root:add(spinnaker, packet())
    add_headers(tree, packet)
    tree:add(f.core, core):set_generated()
    tree:add(f.command, command):set_generated()
    local words = "cut short"
    if packet:len() >= LEAST[command] then
        words = BODIES[command](tree:add(packet(18), command), packet)
    end
    info.cols.protocol = "SpiNNaker"
    info.cols.info = "core " .. core .. " " .. command .. " " .. words
    return packet:len()
end

spinnaker:register_heuristic("udp", function(packet, info, root)
    return spinnaker.dissector(packet, info, root) > 0
end)
DissectorTable.get("udp.port"):add(DEFAULT_PORT, spinnaker)
