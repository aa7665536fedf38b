// Nothing: the target that this file belongs to stands for its precompiled headers.
