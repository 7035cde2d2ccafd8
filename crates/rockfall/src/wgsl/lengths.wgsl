// lengths
